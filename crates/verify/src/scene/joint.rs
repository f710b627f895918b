//! Joints, and the legs along which coordinates drive them.

use dashu_ratio::RBig;

use super::Scene;
use crate::Stop;
use crate::bernstein::choose;
use crate::json::Json;
use crate::pose::Pose;
use crate::real::{Exact, Real};

#[derive(Debug, PartialEq)]
pub(crate) enum Kind {
    Fixed,
    Turn,
    Slide,
}

/// Joint k carries link k.
#[derive(Debug)]
pub(crate) struct Joint {
    pub(crate) parent: usize,
    pub(crate) kind: Kind,
    pub(crate) origin: Pose,
    pub(crate) axis: Exact,
    /// Coordinate, factor and offset of its value.
    drive: (usize, RBig, RBig),
    pub(super) moves: bool,
}

impl Joint {
    /// Returns the value of the joint as a polynomial in time.
    pub(crate) fn value(&self, leg: &Leg) -> Vec<RBig> {
        let mut value: Vec<RBig> = leg.power(self.drive.0).iter().map(|x| x * &self.drive.1).collect();
        value[0] += &self.drive.2;
        value
    }

    /// Returns the value of the joint at these values of the coordinates.
    pub(crate) fn at(&self, coordinate: impl Fn(usize) -> RBig) -> RBig {
        match self.kind {
            Kind::Fixed => RBig::ZERO,
            _ => coordinate(self.drive.0) * &self.drive.1 + &self.drive.2,
        }
    }

    pub(crate) fn coordinate(&self) -> usize {
        self.drive.0
    }

    pub(crate) fn factor(&self) -> &RBig {
        &self.drive.1
    }
}

/// Bezier control points of the coordinates, over the times 0 to 1.
#[derive(Clone, Debug)]
pub(crate) struct Leg(pub(crate) Vec<Vec<Real>>);

impl Leg {
    pub(crate) fn read(json: &Json) -> Result<Self, Stop> {
        json.only(&["leg"])?;
        let row = |x: &Json| x.array()?.iter().map(Json::real).collect::<Result<Vec<_>, _>>();
        let rows = json
            .get("leg")?
            .array()?
            .iter()
            .map(row)
            .collect::<Result<Vec<_>, _>>()?;
        if !(1..=17).contains(&rows.len()) || rows[0].len() > 1024 || rows.iter().any(|x| x.len() != rows[0].len()) {
            return Stop::bad("a leg has 1 to 17 rows of equal length, at most 1024");
        }
        Ok(Self(rows))
    }

    /// Returns the coefficients of a coordinate by powers of t.
    fn power(&self, coordinate: usize) -> Vec<RBig> {
        let mut differences: Vec<RBig> = self.0.iter().map(|row| row[coordinate].exact()).collect();
        let n = differences.len();
        for first in 1..n {
            for k in (first..n).rev() {
                differences[k] = &differences[k] - &differences[k - 1];
            }
        }
        differences
            .into_iter()
            .enumerate()
            .map(|(k, x)| x * RBig::from(choose(n - 1, k)))
            .collect()
    }
}

impl Scene {
    pub(super) fn joint(&mut self, line: &Json) -> Result<(), Stop> {
        let number = self.joints.len() + 1;
        let kind = match line.get("kind")?.text()? {
            "fixed" => Kind::Fixed,
            "turn" => Kind::Turn,
            "slide" => Kind::Slide,
            _ => return Stop::bad("unknown kind of a joint"),
        };
        let fields = ["joint", "parent", "kind", "origin", "axis", "drive"];
        line.only(&fields[..if kind == Kind::Fixed { 4 } else { 6 }])?;
        let parent = line.get("parent")?.whole()?;
        if number > 1024 || line.get("joint")?.whole()? != number || parent >= number {
            return Stop::bad(format!(
                "joint {number} is expected, at most 1024, and a parent before it"
            ));
        }
        let origin = self.pose(line.get("origin")?)?;
        let mut joint = Joint {
            parent,
            kind,
            origin,
            axis: crate::real::zero(),
            drive: Default::default(),
            moves: self.carries(parent),
        };
        if joint.kind != Kind::Fixed {
            let [coordinate, factor, offset] = line.get("drive")?.list::<3>()?;
            joint.axis = line.get("axis")?.reals::<3>()?.map(Real::exact);
            let coordinate = coordinate.whole()?;
            if coordinate >= 1024 {
                return Stop::bad(format!("coordinate {coordinate}, of at most 1024"));
            }
            joint.drive = (coordinate, factor.real()?.exact(), offset.real()?.exact());
            joint.moves = true;
            self.coordinates = self.coordinates.max(joint.drive.0 + 1);
        }
        self.joints.push(joint);
        Ok(())
    }
}
