//! The required distance of each pair: the margin of all pairs or its own, and the paddings of both
//! bodies.

use core::fmt;
use std::format;
use std::string::String;
use std::vec::Vec;

use crate::cell::attached_object::Frame;
use crate::cell::{Cell, Named, check_length};
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::names::{CellBody, CellPair, Select};

/// The distance that a pair must keep, and where it comes from.
///
/// [`Cell::show`](crate::Cell::show) prints the parts with the names of the bodies: `margin`,
/// `margin of the pair`, `padding of post`, or a sum such as `margin 0.02 + padding of post 0.01`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RequiredDistance {
    /// The margin plus both paddings, rounded up.
    pub distance: f64,
    /// The explicit margin of the pair, or else the margin of all pairs.
    pub margin: f64,
    /// Whether the pair has an explicit margin.
    pub is_of_pair: bool,
    /// The padding of each body, with the body that it was set for: the link, if an attached object has
    /// no padding.
    pub paddings: [(CellBody, f64); 2],
    /// What a pair must keep in addition along a motion with a tube: a bound of what the tube moves;
    /// 0 without a tube.
    pub tube: f64,
}

impl fmt::Display for Named<'_, RequiredDistance> {
    /// Writes the parts that are not 0; nothing if all are.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let margin = match self.value.is_of_pair {
            true => "margin of the pair",
            false => "margin",
        };
        let paddings = self.value.paddings.iter().map(|(body, padding)| (Some(body), *padding));
        let parts = core::iter::once((None, self.value.margin)).chain(paddings);
        let parts: Vec<(Option<&CellBody>, f64)> = parts.filter(|(_, part)| *part > 0.0).collect();
        for (k, (body, part)) in parts.iter().enumerate() {
            if k > 0 {
                f.write_str(" + ")?;
            }
            match body {
                Some(body) => write!(f, "padding of {}", self.cell.show(*body))?,
                None => f.write_str(margin)?,
            }
            if parts.len() > 1 {
                write!(f, " {part:?}")?;
            }
        }
        Ok(())
    }
}

impl Named<'_, RequiredDistance> {
    /// Returns what a pair does that does not keep this distance: `meet` if nothing is required, or else
    /// `come within 0.01 m (padding of post)`; inside a tube `may meet in the tube`.
    ///
    /// The unit follows the number, such as `" m"`.
    #[must_use]
    pub fn meet(&self, unit: &str) -> String {
        let (may, within) = match self.value.tube > 0.0 {
            true => ("may ", " in the tube"),
            false => ("", ""),
        };
        match self.value.distance {
            0.0 => format!("{may}meet{within}"),
            _ => format!("{may}come within {}{within}", self.length(unit)),
        }
    }

    /// Returns this distance with its parts: `0.03 m (margin 0.02 + padding of post 0.01)`, or `0 m`.
    ///
    /// The unit follows the number. The number is the nearest to the sum of the parts, of which
    /// [`RequiredDistance::distance`] is an upper bound.
    #[must_use]
    pub fn length(&self, unit: &str) -> String {
        let RequiredDistance { margin, paddings, .. } = self.value;
        match margin + (paddings[0].1 + paddings[1].1) {
            0.0 => format!("0{unit}"),
            sum => format!("{sum:?}{unit} ({self})"),
        }
    }
}

/// Returns the sum of two lengths, rounded up unless it is exact.
fn sum_up(x: f64, y: f64) -> f64 {
    let sum = x + y;
    // The rounding error of the sum, exactly.
    let of_y = sum - x;
    let error = (x - (sum - of_y)) + (y - of_y);
    if error > 0.0 { sum.next_up() } else { sum }
}

/// Margins.
impl Cell {
    /// Sets the distance that every pair without an explicit margin must keep. The default is 0.
    ///
    /// # Errors
    /// Returns an error if the margin is negative or not finite.
    pub fn set_margin(&mut self, margin: f64) -> Result<(), PlanError> {
        check_length("margin", margin)?;
        self.margin = margin;
        self.changes.margin = true;
        Ok(())
    }

    /// Returns the distance that every pair without an explicit margin must keep.
    #[must_use]
    pub fn margin(&self) -> f64 {
        self.margin
    }

    /// Sets the padding of bodies, and returns them: all their pairs must keep so much more.
    ///
    /// The padded body is the body with a rounded layer of this thickness. The default is 0.
    ///
    /// The padding of a link covers the objects that it carries. An attached object with a padding of
    /// its own has that instead, also if it is 0; `None` removes it.
    ///
    /// ```
    /// # use lin_canny_plan::{Cell, CellPair};
    /// # use lin_canny::{Shape, nalgebra::Isometry3};
    /// # let (here, ball) = (Isometry3::identity(), Shape::ball(0.1)?);
    /// let mut cell = Cell::new();
    /// cell.robot_body("hand", ball.clone());
    /// let post = cell.add_obstacle("post", ball.clone(), Isometry3::translation(1.0, 0.0, 0.0))?;
    /// let part = cell.attach("hand", "part", ball, here, &[])?;
    /// cell.pad("hand", 0.01)?;
    /// let pair = CellPair::new(part, post).unwrap();
    /// let required = cell.required_distance(pair);
    /// assert_eq!(required.distance, 0.01);
    /// assert_eq!(cell.show(&required).to_string(), "padding of hand");
    /// cell.pad("part", 0.0)?;
    /// assert_eq!(cell.required_distance(pair).distance, 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the padding is negative or not finite, or if a body does not exist. Then
    /// nothing changes.
    pub fn pad<'a>(
        &mut self,
        bodies: impl Into<Select<'a>>,
        padding: impl Into<Option<f64>>,
    ) -> Result<Vec<CellBody>, PlanError> {
        let padding = padding.into();
        check_length("padding", padding.unwrap_or(0.0))?;
        let found = self.select(bodies)?;
        for id in &found {
            let is_attached = matches!(id, CellBody::Attached(_));
            match padding.filter(|padding| *padding > 0.0 || is_attached) {
                Some(padding) => self.paddings.insert(*id, padding),
                None => self.paddings.remove(id),
            };
        }
        let has_links = found.iter().any(|id| matches!(id, CellBody::Robot(_)));
        let carried: Vec<CellBody> = self.attached().map(|(id, _)| id).filter(|_| has_links).collect();
        self.changes.note(|changes| {
            changes.pairs_of.extend(&found);
            changes.pairs_of.extend(&carried);
        });
        Ok(found)
    }

    /// Returns the padding of a body: of an attached object without its own padding, that of its
    /// link.
    #[must_use]
    pub fn padding(&self, id: CellBody) -> f64 {
        self.padding_from(id).1
    }

    /// Returns the padding that was set for a body; `None` if none was.
    #[must_use]
    pub fn own_padding(&self, id: CellBody) -> Option<f64> {
        self.paddings.get(&id).copied()
    }

    /// Returns the padding of a body, and the body for which it was set.
    fn padding_from(&self, id: CellBody) -> (CellBody, f64) {
        if let Some(own) = self.own_padding(id) {
            return (id, own);
        }
        let object = match id {
            CellBody::Attached(k) => self.attached.get(k).and_then(Option::as_ref),
            _ => None,
        };
        let Some(object) = object else { return (id, 0.0) };
        let is_of_link = |body: CellBody| match body {
            CellBody::Robot(k) => object.frame == Frame::Robot(k) || self.name(body) == object.link,
            _ => false,
        };
        let of_link = self.paddings().filter(|(body, _)| is_of_link(*body));
        of_link.fold((id, 0.0), |most, next| if next.1 > most.1 { next } else { most })
    }

    /// Returns the paddings that were set, in ascending order of the bodies: those above 0, and any of
    /// an attached object.
    pub fn paddings(&self) -> impl ExactSizeIterator<Item = (CellBody, f64)> {
        self.paddings.iter().map(|(id, padding)| (*id, *padding))
    }

    /// Returns the pairs with an explicit margin, in ascending order.
    pub fn margins(&self) -> impl ExactSizeIterator<Item = (CellPair, f64)> {
        self.margins.iter().map(|(pair, margin)| (*pair, *margin))
    }

    /// Sets or removes the explicit margin of all pairs of a body of `a` and a body of `b`, and
    /// returns the pairs. It replaces the [`margin`](Self::margin).
    ///
    /// # Errors
    /// Returns an error if the margin is negative or not finite, if a body does not exist, or if both are
    /// the same body or link. Then nothing changes.
    pub fn set_pair_margin<'a>(
        &mut self,
        a: impl Into<Select<'a>>,
        b: impl Into<Select<'a>>,
        margin: Option<f64>,
    ) -> Result<Vec<CellPair>, PlanError> {
        check_length("margin of a pair", margin.unwrap_or(0.0))?;
        let pairs = self.pairs_of(a.into(), b.into())?;
        for pair in &pairs {
            match margin {
                Some(margin) => self.margins.insert(*pair, margin),
                None => self.margins.remove(pair),
            };
        }
        self.changes.note(|changes| changes.pairs.extend(&pairs));
        Ok(pairs)
    }

    /// Returns the explicit margin of a pair.
    #[must_use]
    pub fn pair_margin(&self, pair: CellPair) -> Option<f64> {
        self.margins.get(&pair).copied()
    }

    /// Returns the distance that a pair must keep, with its parts: its explicit margin, or else the
    /// margin of all pairs, plus the paddings of both bodies.
    #[must_use]
    pub fn required_distance(&self, pair: CellPair) -> RequiredDistance {
        let of_pair = self.pair_margin(pair);
        let margin = of_pair.unwrap_or(self.margin);
        let paddings = match self.paddings.is_empty() {
            true => [(pair.a, 0.0), (pair.b, 0.0)],
            false => [pair.a, pair.b].map(|id| self.padding_from(id)),
        };
        RequiredDistance {
            distance: sum_up(margin, sum_up(paddings[0].1, paddings[1].1)),
            margin,
            is_of_pair: of_pair.is_some(),
            paddings,
            tube: 0.0,
        }
    }

    /// Returns whether a pair may have a required distance above 0: a margin or a padding was set.
    #[must_use]
    pub fn requires_distance(&self) -> bool {
        let lengths = self.margins.values().chain(self.paddings.values());
        lengths.chain([&self.margin]).any(|length| *length > 0.0)
    }

    /// Returns an upper bound of what a pair with an obstacle must keep without the padding of the
    /// other body, and a lower bound of what any pair must keep.
    pub(crate) fn kept_bounds(&self) -> (f64, f64) {
        let margins = || self.margins.values().copied();
        let most = margins().fold(self.margin, f64::larger);
        let pads = self
            .paddings
            .iter()
            .filter(|(id, _)| matches!(id, CellBody::Obstacle(_)));
        let pad = pads.map(|(_, pad)| *pad).fold(0.0, f64::larger);
        (most + pad, margins().fold(self.margin, f64::smaller))
    }
}
