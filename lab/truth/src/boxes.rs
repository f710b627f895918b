//! Moving boxes: the scenes of the tests and benchmarks of the broad phase, with fixed seeds.

use crate::rng::Rng;
use lin_canny::broad::Aabb;
use nalgebra::{Point3, Vector3};

/// The scenes, with the names that the benchmarks print.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// 16 cubic units per box of about one unit; random directions, 0.01 per step.
    Uniform,
    /// Like `Uniform`, with 0.002 per step.
    UniformSlow,
    /// Four layers of unit boxes on a square, each jostling near its cell; about three pairs per
    /// box.
    Pile,
    /// `Uniform` with one box in a hundred moving.
    Movers,
    /// `Uniform` with one box in twenty moved to a random position in each step.
    Teleport,
    /// Sides from 0.1 to 100, moving by a hundredth of their size per step.
    Mixed,
    /// Sixteen balls, each as dense as `Uniform`, in a world ten times as wide.
    Clusters,
    /// All boxes on one floor, drifting sideways: one axis is degenerate.
    Floor,
}

impl Kind {
    /// All scenes, in the order of the races.
    pub const ALL: [Self; 8] = [
        Self::Uniform,
        Self::UniformSlow,
        Self::Pile,
        Self::Movers,
        Self::Teleport,
        Self::Mixed,
        Self::Clusters,
        Self::Floor,
    ];

    /// The name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::UniformSlow => "uniform-slow",
            Self::Pile => "pile",
            Self::Movers => "movers-1%",
            Self::Teleport => "teleport-5%",
            Self::Mixed => "mixed",
            Self::Clusters => "clusters",
            Self::Floor => "floor",
        }
    }
}

/// Boxes in motion. Each box moves in its room and bounces off the walls.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Kind of the scene.
    pub kind: Kind,
    /// The boxes of this frame.
    pub boxes: Vec<Aabb>,
    /// Indices of the boxes that moved in the last step, ascending.
    pub moved: Vec<u32>,
    center: Vec<Point3<f64>>,
    half: Vec<Vector3<f64>>,
    velocity: Vec<Vector3<f64>>,
    /// Centre and half side of the room of each box.
    room: Vec<(Point3<f64>, Vector3<f64>)>,
    random: Rng,
    world: f64,
}

impl Scene {
    /// Returns a scene of `n` boxes, always the same.
    pub fn new(kind: Kind, n: usize) -> Self {
        let world = match kind {
            Kind::Clusters => 10.0 * (16.0 * n as f64).cbrt(),
            Kind::Mixed => (MIXED_VOLUME * n as f64).cbrt(),
            Kind::Floor => (6.0 * n as f64).sqrt(),
            _ => (16.0 * n as f64).cbrt(),
        };
        let mut scene = Self {
            kind,
            boxes: Vec::new(),
            moved: Vec::new(),
            center: Vec::new(),
            half: Vec::new(),
            velocity: Vec::new(),
            room: Vec::new(),
            random: Rng::new(0x5EED + n as u64),
            world,
        };
        match kind {
            Kind::Pile => scene.fill_pile(n),
            Kind::Clusters => scene.fill_clusters(n),
            _ => (0..n).for_each(|_| scene.add_free()),
        }
        for i in 0..n {
            scene.place(i);
        }
        scene
    }

    /// Returns the scene with boxes `factor` times as large, so that more of them overlap.
    pub fn grown(mut self, factor: f64) -> Self {
        self.half.iter_mut().for_each(|h| *h *= factor);
        (0..self.boxes.len()).for_each(|i| self.place(i));
        self
    }

    fn add(&mut self, center: Point3<f64>, half: Vector3<f64>, speed: f64, room: (Point3<f64>, Vector3<f64>)) {
        let mut velocity = Vector3::from(self.random.unit()) * speed;
        if self.kind == Kind::Floor {
            velocity.z = 0.0;
        }
        self.center.push(center);
        self.half.push(half);
        self.velocity.push(velocity);
        self.room.push(room);
        self.boxes.push(Aabb::from_center(center, half));
    }

    /// Adds a box at a random position in the world.
    fn add_free(&mut self) {
        let half_world = 0.5 * self.world;
        let (side, speed) = match self.kind {
            Kind::Mixed => {
                let side = 0.1 * 1000_f64.powf(self.random.uniform().powi(12));
                (Vector3::repeat(side), 0.01 * side)
            }
            Kind::UniformSlow => (Vector3::from_fn(|_, _| self.random.range(0.8, 1.2)), 0.002),
            _ => (Vector3::from_fn(|_, _| self.random.range(0.8, 1.2)), 0.01),
        };
        let mut center = Point3::from(Vector3::from_fn(|_, _| self.random.range(-half_world, half_world)));
        let mut room = Vector3::repeat(half_world);
        if self.kind == Kind::Floor {
            center.z = 0.5 * side.z;
            room.z = f64::INFINITY;
        }
        self.add(center, 0.5 * side, speed, (Point3::origin(), room));
    }

    fn fill_pile(&mut self, n: usize) {
        let side = ((n as f64 / 4.0).sqrt().ceil() as usize).max(1);
        let mut cells: Vec<usize> = (0..side * side * 4).collect();
        // Neighbours in space are far apart in memory: the worst case.
        self.random.shuffle(&mut cells);
        for cell in cells.into_iter().take(n) {
            let at = [cell / 4 % side, cell / 4 / side, cell % 4].map(|v| v as f64);
            let home = Point3::new(at[0], at[1], at[2]);
            let jitter = Vector3::from_fn(|_, _| self.random.range(-0.1, 0.1));
            self.add(home + jitter, Vector3::repeat(0.5), 0.01, (home, Vector3::repeat(0.1)));
        }
    }

    fn fill_clusters(&mut self, n: usize) {
        // A ball of n / 16 boxes at 16 cubic units each.
        let radius = (3.0 * n as f64 / (4.0 * std::f64::consts::PI)).cbrt();
        let half_world = 0.5 * self.world - radius;
        let centers: Vec<Point3<f64>> = (0..16)
            .map(|_| Point3::from(Vector3::from_fn(|_, _| self.random.range(-half_world, half_world))))
            .collect();
        for i in 0..n {
            let home = centers[i % 16];
            let at = home + Vector3::from(self.random.in_ball()) * radius;
            let half = 0.5 * Vector3::from_fn(|_, _| self.random.range(0.8, 1.2));
            self.add(at, half, 0.01, (home, Vector3::repeat(radius)));
        }
    }

    fn place(&mut self, i: usize) {
        self.boxes[i] = Aabb::from_center(self.center[i], self.half[i]);
    }

    fn advance(&mut self, i: usize) {
        let (home, room) = self.room[i];
        for k in 0..3 {
            let next = self.center[i][k] + self.velocity[i][k];
            if (next - home[k]).abs() > room[k] && (next - home[k]) * self.velocity[i][k] > 0.0 {
                self.velocity[i][k] = -self.velocity[i][k];
            }
            self.center[i][k] += self.velocity[i][k];
        }
        self.place(i);
        self.moved.push(i as u32);
    }

    /// Advances the scene by one frame.
    pub fn step(&mut self) {
        self.moved.clear();
        let n = self.boxes.len();
        let stride = if self.kind == Kind::Movers { 100 } else { 1 };
        for i in (0..n).step_by(stride) {
            if self.kind == Kind::Teleport && self.random.below(20) == 0 {
                let half_world = 0.5 * self.world;
                let anywhere = Vector3::from_fn(|_, _| self.random.range(-half_world, half_world));
                self.center[i] = Point3::from(anywhere);
            }
            self.advance(i);
        }
    }
}

/// Chosen so that a box of the mixed scene has about 0.8 pairs.
const MIXED_VOLUME: f64 = 5500.0;

/// Returns all pairs of indices, `a < b`, whose boxes overlap, by testing every pair.
pub fn brute_force<B>(boxes: &[B], overlap: impl Fn(&B, &B) -> bool) -> Vec<(u32, u32)> {
    let mut pairs = Vec::new();
    for (a, first) in boxes.iter().enumerate() {
        for (b, second) in boxes.iter().enumerate().skip(a + 1) {
            if overlap(first, second) {
                pairs.push((a as u32, b as u32));
            }
        }
    }
    pairs
}
