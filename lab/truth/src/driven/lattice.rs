//! Worlds of equal bounds: bricks, lattices, stacks and bars, judged by brute force after every
//! step.
//!
//! Coordinates are multiples of 2^-5, so ties are everywhere and every box is exact in `f32`. Few
//! bodies change in a step: they jump away and back, pass their index to another body, or slide by
//! a fraction of a column. The judge compares with brute force over the given boxes.
//!
//! The test `broad` and the instrument `soak` share this module.

use crate::rng::Rng;
use lin_canny::broad::{Aabb, BodyId, BodyOptions, SweepAndPrune};
use lin_canny::nalgebra::{Point3, Vector3};

crate::tally! {
    /// Counts of some sequences; if a count is zero, its ingredient was not tested.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Sequences played.
        pub sequences: u64,
        /// Steps judged.
        pub steps: u64,
        /// Pairs of all steps.
        pub pairs: u64,
        /// Events of all steps.
        pub events: u64,
        /// Bodies moved by more than one unit along an axis.
        pub jumps: u64,
        /// Bodies moved by less.
        pub slides: u64,
        /// Bodies that were given the index of a removed body.
        pub reused: u64,
        /// Worlds rotated as a whole to another axis.
        pub turns: u64,
        /// Steps in which at most a tenth of the bodies were changed.
        pub quiet: u64,
    }
}

/// A box by its lower corner and its sides, all multiples of 2^-5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brick {
    /// Lower corner.
    pub low: [f64; 3],
    /// Sides.
    pub side: [f64; 3],
}

impl Brick {
    fn aabb(&self) -> Aabb {
        let low = Point3::from(self.low);
        Aabb::new(low, low + Vector3::from(self.side))
    }

    fn shifted(&self, by: [f64; 3]) -> Self {
        let low = core::array::from_fn(|k| self.low[k] + by[k]);
        Self { low, ..*self }
    }

    /// Returns the brick along the next axis.
    fn turned(mut self) -> Self {
        self.low.rotate_left(1);
        self.side.rotate_left(1);
        self
    }

    fn meets(&self, other: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= other.low[k] + other.side[k] && other.low[k] <= self.low[k] + self.side[k])
    }
}

/// Returns the bricks of one of the families, with ties on at least one axis.
pub fn world(rng: &mut Rng) -> Vec<Brick> {
    let gap = *rng.pick(&[0.75, 1.0, 1.0, 1.25, 1.5, 2.0, 3.0]);
    let most = if rng.chance(0.02) { 8 } else { 4 };
    let size: [usize; 3] = match rng.below(4) {
        0 => [1 + rng.below(most), 2 + rng.below(most), 1],
        1 => [2, 1 + rng.below(3), 1 + rng.below(4)],
        2 => [1, 1, 3 + rng.below(20)],
        _ => [1 + rng.below(5), 1 + rng.below(5), 1 + rng.below(2)],
    };
    let turn = rng.below(3);
    let long = if rng.chance(0.2) {
        *rng.pick(&[3.0, 8.0, 20.0])
    } else {
        1.0
    };
    let few_long = rng.chance(0.5);
    let mut bricks = Vec::new();
    for i in 0..size[0] {
        for j in 0..size[1] {
            for k in 0..size[2] {
                let mut low = [i, j, k].map(|i| i as f64 * gap);
                low.rotate_left(turn);
                let mut side = [1.0; 3];
                if long > 1.0 && (!few_long || rng.chance(0.1)) {
                    side[rng.below(3)] = long;
                }
                bricks.push(Brick { low, side });
            }
        }
    }
    bricks
}

struct Held {
    id: BodyId,
    brick: Brick,
    home: Brick,
    slide: [f64; 3],
}

/// One world.
struct Play {
    broad: SweepAndPrune,
    held: Vec<Held>,
    rng: Rng,
    mix: Mix,
}

impl Play {
    fn insert(&mut self, brick: Brick) -> Result<(), String> {
        let fixed = self.rng.chance(0.05);
        let body = if fixed {
            BodyOptions::default().fixed(true)
        } else {
            BodyOptions::default()
        };
        let id = self.broad.insert(&brick.aabb(), body).map_err(|e| e.to_string())?;
        let slide = [0.0; 3];
        self.held.push(Held {
            id,
            brick,
            home: brick,
            slide,
        });
        Ok(())
    }

    fn set(&mut self, i: usize, brick: Brick) -> Result<(), String> {
        let held = &mut self.held[i];
        let far = (0..3).any(|k| (held.brick.low[k] - brick.low[k]).abs() > 1.0);
        self.mix.jumps += u64::from(far);
        self.mix.slides += u64::from(!far && brick != held.brick);
        held.brick = brick;
        self.broad.set_box(held.id, &brick.aabb()).map_err(|e| e.to_string())
    }

    /// Rotates the world: its long axis changes.
    fn turn(&mut self) -> Result<(), String> {
        self.mix.turns += 1;
        for i in 0..self.held.len() {
            self.held[i].home = self.held[i].home.turned();
            self.set(i, self.held[i].brick.turned())?;
        }
        Ok(())
    }

    /// Sets a new direction, with a fraction of a brick per step.
    fn direct(&mut self, i: usize) {
        let speed = *self.rng.pick(&[0.03125, 0.0625, 0.125, 0.25, 0.25, 0.5]);
        let mut slide = [0.0; 3];
        slide[self.rng.below(3)] = if self.rng.chance(0.5) { speed } else { -speed };
        self.held[i].slide = slide;
    }

    /// Changes one body.
    fn change(&mut self, i: usize) -> Result<(), String> {
        let (brick, home, slide) = (self.held[i].brick, self.held[i].home, self.held[i].slide);
        match self.rng.below(16) {
            0 | 1 => {
                let far = *self.rng.pick(&[5.0, 50.0, -40.0, 65536.0]);
                let by = [far, if self.rng.chance(0.5) { far } else { 0.0 }, 0.0];
                self.set(i, home.shifted(by))
            }
            2 | 3 => self.set(i, home),
            4 => {
                let other = self.rng.below(self.held.len());
                let at = self.held[other].brick.low;
                self.set(i, Brick { low: at, ..brick })
            }
            5 | 6 => {
                let gone = self.held.swap_remove(i);
                self.broad.remove(gone.id).map_err(|e| e.to_string())?;
                if self.rng.chance(0.5) {
                    self.step()?; // the index is free only now
                    self.mix.reused += 1;
                }
                self.insert(gone.home)
            }
            7 | 8 => {
                self.direct(i);
                Ok(())
            }
            _ => self.set(i, brick.shifted(slide)),
        }
    }

    fn step(&mut self) -> Result<(), String> {
        let events = self.broad.step();
        self.mix.steps += 1;
        self.mix.events += (events.began.len() + events.ended.len()) as u64;
        self.judge()
    }

    fn judge(&mut self) -> Result<(), String> {
        self.broad.check()?;
        let mut found: Vec<(u32, u32)> = self.broad.pairs().map(|p| (p.a.index, p.b.index)).collect();
        found.sort_unstable();
        let mut expected = Vec::new();
        for (k, a) in self.held.iter().enumerate() {
            for b in self.held[..k].iter().filter(|b| a.brick.meets(&b.brick)) {
                let fixed = |id| self.broad.body(id).is_some_and(|body| body.fixed);
                if !(fixed(a.id) && fixed(b.id)) {
                    expected.push((a.id.index.min(b.id.index), a.id.index.max(b.id.index)));
                }
            }
        }
        expected.sort_unstable();
        self.mix.pairs += expected.len() as u64;
        if found == expected {
            return Ok(());
        }
        let lost: Vec<_> = expected.iter().filter(|p| !found.contains(p)).collect();
        let phantom: Vec<_> = found.iter().filter(|p| !expected.contains(p)).collect();
        Err(format!("step {}: lost {lost:?}, phantom {phantom:?}", self.mix.steps))
    }
}

/// Plays one sequence; the same seed makes the same calls.
///
/// # Errors
/// Returns the lost and the phantom pairs, or the violated invariant.
pub fn sequence(seed: u64, broad: SweepAndPrune) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let bricks = world(&mut rng);
    let mut play = Play {
        broad,
        held: Vec::new(),
        rng,
        mix: Mix {
            sequences: 1,
            ..Mix::default()
        },
    };
    for brick in bricks {
        play.insert(brick)?;
    }
    play.step()?;
    let steps = 4 + play.rng.below(20);
    // A few bodies get most of the changes, so that what one call leaves behind meets the next.
    let busy = 1 + play.rng.below(3);
    for _ in 0..steps {
        if play.rng.chance(0.03) {
            play.turn()?;
        }
        let crowd = play.rng.chance(0.1);
        let moves = if crowd { play.held.len() } else { 1 + play.rng.below(2) };
        play.mix.quiet += u64::from(moves * 10 <= play.held.len());
        for _ in 0..moves {
            let n = play.held.len();
            let i = if crowd {
                play.rng.below(n)
            } else {
                n - 1 - play.rng.below(busy.min(n))
            };
            play.change(i)?;
        }
        play.step()?;
    }
    Ok(play.mix)
}
