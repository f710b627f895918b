//! The trackers of pairs with a geometry that is not convex, behind one interface.

use alloc::boxed::Box;
use alloc::sync::Arc;
use core::any::Any;
use core::fmt::Debug;

use nalgebra::Point3;

use super::engine::BodyShapes;
#[cfg(feature = "serde")]
use super::mixed::StoredTracker;
use super::pair::Asked;
use super::work::PairWork;
use crate::base::pose::Operand;

/// A tracker of one pair of kinds, and the bodies that stand for others.
#[derive(Clone, Debug)]
pub(super) struct Tracked<T, S> {
    pub(super) tracker: T,
    /// The body in the form in which the tracker takes it, for a body of another kind.
    pub(super) stand_ins: [Option<Arc<S>>; 2],
}

impl<T: Default, S> Tracked<T, S> {
    pub(super) fn new(stand_ins: [Option<Arc<S>>; 2]) -> Box<Self> {
        let tracker = T::default();
        Box::new(Self { tracker, stand_ins })
    }

    /// Returns the tracker and both bodies, their own or the stand-ins.
    pub(super) fn sides<'p>(&'p mut self, own: [Option<&'p S>; 2]) -> Option<(&'p mut T, [&'p S; 2])> {
        let [x, y] = &self.stand_ins;
        let sides = [own[0].or(x.as_deref())?, own[1].or(y.as_deref())?];
        Some((&mut self.tracker, sides))
    }

    /// Returns one of both bodies, its own or the stand-in.
    pub(super) fn side<'p>(&'p self, own: [Option<&'p S>; 2], of: Operand) -> Option<&'p S> {
        let k = usize::from(of == Operand::B);
        own[k].or(self.stand_ins[k].as_deref())
    }
}

/// A tracker of one pair of kinds: how it takes two geometries. For geometries of another pair all
/// answers are `None`.
pub(super) trait PairOfKinds {
    type Pair<'p>: Asked
    where
        Self: 'p;

    /// Returns the pair and the tracker.
    fn pair<'p>(&'p mut self, bodies: BodyShapes<'p>) -> Option<Self::Pair<'p>>;

    /// Returns a ball that contains a body, as [`Separation::ball`](crate::separation::Separation).
    fn ball(&self, bodies: BodyShapes<'_>, of: Operand) -> Option<(Point3<f64>, f64)>;

    /// Returns the work of all queries so far.
    fn work(&self) -> PairWork;

    /// Returns the number of entries of the front that is kept.
    fn front_len(&self) -> usize;

    /// Returns the bytes on the heap behind the tracker.
    fn heap_bytes(&self) -> usize;

    /// Returns what is written of a tracker whose last measurement named these parts.
    #[cfg(feature = "serde")]
    fn stored(&self, parts: [u32; 2]) -> StoredTracker;
}

/// What the trackers of all kinds count and keep by one name.
macro_rules! counters {
    ($work:ident, $stored:ident) => {
        fn work(&self) -> PairWork {
            PairWork::$work(self.tracker.work())
        }

        fn front_len(&self) -> usize {
            self.tracker.front_len()
        }

        fn heap_bytes(&self) -> usize {
            self.tracker.heap_bytes()
        }

        #[cfg(feature = "serde")]
        fn stored(&self, parts: [u32; 2]) -> StoredTracker {
            StoredTracker::$stored(parts)
        }
    };
}

pub(super) use counters;

/// A [`PairOfKinds`] behind a pointer.
pub(super) trait AnyKinds: Any + Debug + Send + Sync {
    /// Calls `ask` with the pair; not for geometries of another pair.
    fn ask(&mut self, bodies: BodyShapes<'_>, ask: &mut dyn FnMut(&mut dyn Asked));

    fn ball(&self, bodies: BodyShapes<'_>, of: Operand) -> Option<(Point3<f64>, f64)>;

    fn work(&self) -> PairWork;

    fn front_len(&self) -> usize;

    /// Returns the bytes on the heap, those of the tracker itself among them.
    fn heap_bytes(&self) -> usize;

    #[cfg(feature = "serde")]
    fn stored(&self, parts: [u32; 2]) -> StoredTracker;

    fn boxed(&self) -> Box<dyn AnyKinds>;
}

impl<K: PairOfKinds + Any + Clone + Debug + Send + Sync> AnyKinds for K {
    fn ask(&mut self, bodies: BodyShapes<'_>, ask: &mut dyn FnMut(&mut dyn Asked)) {
        if let Some(mut pair) = self.pair(bodies) {
            ask(&mut pair);
        }
    }

    fn ball(&self, bodies: BodyShapes<'_>, of: Operand) -> Option<(Point3<f64>, f64)> {
        PairOfKinds::ball(self, bodies, of)
    }

    fn work(&self) -> PairWork {
        PairOfKinds::work(self)
    }

    fn front_len(&self) -> usize {
        PairOfKinds::front_len(self)
    }

    fn heap_bytes(&self) -> usize {
        size_of::<Self>() + PairOfKinds::heap_bytes(self)
    }

    #[cfg(feature = "serde")]
    fn stored(&self, parts: [u32; 2]) -> StoredTracker {
        PairOfKinds::stored(self, parts)
    }

    fn boxed(&self) -> Box<dyn AnyKinds> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn AnyKinds> {
    fn clone(&self) -> Self {
        (**self).boxed()
    }
}
