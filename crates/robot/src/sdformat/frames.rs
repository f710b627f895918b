//! The frames of an SDFormat file: where each is drawn, and the link that each moves with.
//!
//! Poses are relative to frames (`relative_to`), and frames are attached to frames (`attached_to`).
//! These are two graphs. In each of them, a frame leads to exactly one other frame, and finally to
//! the world or to a link. A pose says where a frame is drawn; an attachment says what it moves
//! with.
//!
//! A name belongs to a scope: the world or a model. `a::b` is the frame `b` in the model `a`.

use std::collections::HashMap;

use lin_canny::nalgebra::Isometry3;
use lin_canny::normalize_rotation;

use crate::error::{FileError, FileErrorKind, Place};
use crate::xml::EXTENT_MAX;
use lin_canny_plan::nearest_name as nearest;

/// The frame of the world, which has the scope of the same number.
pub(super) const WORLD: usize = 0;

/// The most frames between two frames whose relative pose does not pass through the world.
const NEAR: usize = 1000;

/// The name of a frame as an element of a model states it.
#[derive(Clone)]
pub(super) struct Reference {
    pub(super) place: Place,
    pub(super) scope: usize,
    /// The frame that `__model__` names here.
    pub(super) model: usize,
    pub(super) name: String,
}

/// A frame, by number or by name.
#[derive(Clone)]
pub(super) enum Target {
    Frame(usize),
    Named(Reference),
}

/// What a frame moves with.
pub(super) enum Attachment {
    World,
    Link(usize),
    To(Target),
    /// The frame of a model without links.
    Nothing,
}

/// What carries a frame in the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Carrier {
    World,
    Link(usize),
    Nothing,
}

pub(super) struct Frame {
    pub(super) place: Place,
    pub(super) name: String,
    pub(super) relative_to: Target,
    pub(super) pose: Isometry3<f64>,
    /// The frame in the model that is at the pose, instead of the frame of the model.
    pub(super) placement: Option<Reference>,
    pub(super) attached_to: Attachment,
}

/// The names of a model or of the world.
#[derive(Default)]
pub(super) struct Scope {
    pub(super) frames: HashMap<String, usize>,
    /// The scopes of the models in it.
    pub(super) models: HashMap<String, usize>,
}

/// All frames of a file, and of the files that it includes.
pub(super) struct Frames {
    pub(super) frames: Vec<Frame>,
    pub(super) scopes: Vec<Scope>,
}

/// The poses and carriers of all frames.
pub(super) struct Poses {
    parents: Vec<usize>,
    /// The number of frames up to the world.
    depths: Vec<usize>,
    /// The pose of each frame in its parent.
    local: Vec<Isometry3<f64>>,
    /// The pose of each frame in the world.
    pub(super) global: Vec<Isometry3<f64>>,
    pub(super) carriers: Vec<Carrier>,
}

impl Frames {
    /// Returns the frame of the world, named `world`.
    pub(super) fn new(place: Place) -> Self {
        let world = Frame {
            place,
            name: "world".into(),
            relative_to: Target::Frame(WORLD),
            pose: Isometry3::identity(),
            placement: None,
            attached_to: Attachment::World,
        };
        let names = Scope {
            frames: HashMap::from([("world".into(), WORLD)]),
            models: HashMap::new(),
        };
        Self {
            frames: vec![world],
            scopes: vec![names],
        }
    }

    /// Adds a frame without a name.
    pub(super) fn add(&mut self, frame: Frame) -> usize {
        self.frames.push(frame);
        self.frames.len() - 1
    }

    /// Returns the frame of a name.
    pub(super) fn find(&self, reference: &Reference) -> Result<usize, FileError> {
        let (mut scope, mut rest) = (reference.scope, reference.name.as_str());
        if rest == "__model__" && reference.model != WORLD {
            return Ok(reference.model);
        }
        loop {
            if let Some(&frame) = self.scopes[scope].frames.get(rest) {
                return Ok(frame);
            }
            let inner = rest.split_once("::");
            let inner = inner.and_then(|(first, rest)| Some((*self.scopes[scope].models.get(first)?, rest)));
            match inner {
                Some(inner) => (scope, rest) = inner,
                None => return Err(self.unknown(reference, "frame")),
            }
        }
    }

    /// Returns the error of a name that nothing has.
    pub(super) fn unknown(&self, reference: &Reference, kind: &'static str) -> FileError {
        let mut names = Vec::new();
        let mut scopes = vec![(reference.scope, String::new())];
        while let Some((scope, prefix)) = scopes.pop() {
            let scope = &self.scopes[scope];
            let frames = scope.frames.keys().filter(|name| *name != "__model__");
            names.extend(frames.map(|name| format!("{prefix}{name}")));
            scopes.extend(
                scope
                    .models
                    .iter()
                    .map(|(name, inner)| (*inner, format!("{prefix}{name}::"))),
            );
        }
        // The order of a hash map differs from run to run.
        names.sort_unstable();
        reference.place.error(FileErrorKind::Unknown {
            kind,
            name: reference.name.clone(),
            near: nearest(&reference.name, names.iter().map(String::as_str)),
        })
    }

    /// Returns the number of a frame.
    pub(super) fn number(&self, target: &Target) -> Result<usize, FileError> {
        match target {
            Target::Frame(frame) => Ok(*frame),
            Target::Named(reference) => self.find(reference),
        }
    }

    /// Returns all poses and carriers.
    pub(super) fn resolve(&self) -> Result<Poses, FileError> {
        let parents = self.frames.iter().map(|frame| self.number(&frame.relative_to));
        let parents: Vec<usize> = parents.collect::<Result<_, _>>()?;
        let above: Vec<Option<usize>> = parents.iter().map(|&k| Some(k)).collect();
        let order = self.ordered(above, "relative_to")?;
        let (global, depths) = (vec![Isometry3::identity(); order.len()], vec![0; order.len()]);
        let mut poses = Poses {
            local: self.frames.iter().map(|frame| frame.pose).collect(),
            carriers: self.carriers()?,
            parents,
            depths,
            global,
        };
        for &k in order.iter().rev() {
            if let Some(placement) = &self.frames[k].placement {
                let outside = || {
                    let what = format!(
                        "invalid placement frame: {:?} (expected a frame of the model)",
                        placement.name
                    );
                    placement.place.error(FileErrorKind::Malformed(what))
                };
                let inside = poses.below(self.find(placement)?, k).ok_or_else(outside)?;
                poses.local[k] *= inside.inverse();
            }
        }
        for &k in order.iter().filter(|k| **k != WORLD) {
            let parent = poses.parents[k];
            poses.depths[k] = poses.depths[parent] + 1;
            poses.global[k] = normalize_rotation(&(poses.global[parent] * poses.local[k]));
            let value = poses.global[k].translation.vector.amax();
            if !(value <= EXTENT_MAX) {
                let field = "position in the world".into();
                return Err(self.frames[k].place.error(FileErrorKind::Range { field, value }));
            }
        }
        Ok(poses)
    }

    /// Returns what carries each frame.
    fn carriers(&self) -> Result<Vec<Carrier>, FileError> {
        let next = self.frames.iter().map(|frame| match &frame.attached_to {
            Attachment::To(target) => self.number(target).map(Some),
            _ => Ok(None),
        });
        let next: Vec<Option<usize>> = next.collect::<Result<_, _>>()?;
        let mut carriers = vec![Carrier::Nothing; next.len()];
        for k in self.ordered(next.clone(), "attached_to")? {
            carriers[k] = match (&self.frames[k].attached_to, next[k]) {
                (_, Some(other)) => carriers[other],
                (Attachment::World, _) => Carrier::World,
                (Attachment::Link(link), _) => Carrier::Link(*link),
                _ => Carrier::Nothing,
            };
        }
        Ok(carriers)
    }

    /// Returns all frames, each after the one that it leads to.
    fn ordered(&self, mut next: Vec<Option<usize>>, attribute: &str) -> Result<Vec<usize>, FileError> {
        next[WORLD] = None;
        let mut order = Vec::new();
        // The position of a frame in the path, and whether it is in the order.
        let mut seen: Vec<Option<usize>> = vec![None; next.len()];
        let mut is_done = vec![false; next.len()];
        for start in 0..next.len() {
            let (mut path, mut at) = (Vec::new(), Some(start));
            while let Some(k) = at.filter(|k| !is_done[*k]) {
                if let Some(first) = seen[k] {
                    let names = path[first..].iter().map(|k: &usize| self.frames[*k].name.as_str());
                    let names: Vec<&str> = names.take(10).collect();
                    let what = format!("{attribute} forms a cycle: {} (expected none)", names.join(", "));
                    return Err(self.frames[path[first]].place.error(FileErrorKind::Malformed(what)));
                }
                seen[k] = Some(path.len());
                path.push(k);
                at = next[k];
            }
            path.iter().for_each(|k| is_done[*k] = true);
            order.extend(path.iter().rev());
        }
        Ok(order)
    }
}

impl Poses {
    /// Returns the pose of a frame in a frame that it is relative to, directly or through others.
    fn below(&self, frame: usize, base: usize) -> Option<Isometry3<f64>> {
        let (mut at, mut pose) = (frame, Isometry3::identity());
        while at != base {
            if at == WORLD {
                return None;
            }
            pose = self.local[at] * pose;
            at = self.parents[at];
        }
        Some(pose)
    }

    /// Returns the pose of a frame in another one.
    ///
    /// The path leads through the first frame that both are relative to, so that a distance from
    /// the world costs no accuracy.
    pub(super) fn between(&self, frame: usize, base: usize) -> Isometry3<f64> {
        let (mut a, mut b) = (frame, base);
        let (mut of_frame, mut of_base) = (Isometry3::identity(), None);
        for _ in 0..NEAR {
            if a == b {
                let to_base = of_base.map_or(of_frame, |base: Isometry3<f64>| base.inverse() * of_frame);
                return normalize_rotation(&to_base);
            }
            if self.depths[a] >= self.depths[b] {
                of_frame = self.local[a] * of_frame;
                a = self.parents[a];
            } else {
                of_base = Some(of_base.map_or(self.local[b], |base| self.local[b] * base));
                b = self.parents[b];
            }
        }
        normalize_rotation(&(self.global[base].inverse() * self.global[frame]))
    }
}
