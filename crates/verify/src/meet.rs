//! Two bodies share a point.
//!
//! **Lemma 4.** Let d_k = a_k - b_k, k = 0 to 3, be differences of vertices of A and B, and (ijk)
//! the volume d_i . (d_j x d_k). By Cramer's rule (123) d_0 - (023) d_1 + (013) d_2 - (012) d_3 =
//! 0. If these four factors have no two opposite signs and are not all zero, 0 is a mean of the
//! d_k with weights that are not negative. The same mean of the a_k and of the b_k is one point,
//! in both hulls.
//!
//! At rest the volumes are fractions, and a zero is known to be one: touching is proven. In motion
//! all four signs must be certain. The indices carry no number, so nothing is rounded.

use crate::Stop;
use crate::claim::{AtMoment, Claim, Moment};
use crate::half_space;
use crate::int::Int;
use crate::json::Json;
use crate::motion::Stage;
use crate::real::{cross as exact_cross, dot as exact_dot, minus as exact_minus};
use crate::scene::Scene;
use crate::vectors::{cross, dot, minus};

/// Four pairs of vertices whose differences enclose 0.
pub(crate) struct Meet {
    moment: Moment,
    pairs: [[usize; 2]; 4],
}

fn enclose(sign: impl Fn(usize, usize, usize) -> i32, exact: bool) -> bool {
    let signs = [sign(1, 2, 3), -sign(0, 2, 3), sign(0, 1, 3), -sign(0, 1, 2)];
    let known = if exact { signs != [0; 4] } else { !signs.contains(&0) };
    known && (!signs.contains(&-1) || !signs.contains(&1))
}

impl Meet {
    pub(crate) fn read(scene: &Scene, line: &Json) -> Result<Self, Stop> {
        line.only(&["meet", "at", "points"])?;
        let moment = Moment::read(scene, line)?;
        half_space::refuse(scene, moment.pair)?;
        let mut pairs = [[0; 2]; 4];
        for (pair, json) in pairs.iter_mut().zip(line.get("points")?.list::<4>()?) {
            let [i, j] = json.list::<2>()?;
            *pair = [i.whole()?, j.whole()?];
            moment.has(scene, *pair)?;
        }
        moment.in_part(scene, [&pairs.map(|pair| pair[0]), &pairs.map(|pair| pair[1])])?;
        Ok(Self { moment, pairs })
    }
}

impl AtMoment for Meet {
    fn moment(&self) -> &Moment {
        &self.moment
    }

    fn says(&self, scene: &Scene) -> String {
        format!("{} share a point", self.moment.text(scene))
    }

    fn at_rest(&self, scene: &Scene) -> Result<bool, Stop> {
        let (a, b) = (scene.placed(self.moment.pair.0)?, scene.placed(self.moment.pair.1)?);
        let difference = |[i, j]: [usize; 2]| Some(exact_minus(&a.get(i)?, &b.get(j)?));
        let Some(d) = self.pairs.iter().map(|p| difference(*p)).collect::<Option<Vec<_>>>() else {
            return Ok(false);
        };
        let sign = |i: usize, j: usize, k: usize| {
            let volume = exact_dot(&d[i], &exact_cross(&d[j], &d[k]));
            i32::from(volume > dashu_ratio::RBig::ZERO) - i32::from(volume < dashu_ratio::RBig::ZERO)
        };
        Ok(enclose(sign, true))
    }
}

impl Claim for Meet {
    fn holds<I: Int>(&self, scene: &Scene, stage: &Stage<I>) -> Option<bool> {
        let (span, (a, b)) = (self.moment.span(), self.moment.pair);
        let mut d = Vec::new();
        for [i, j] in self.pairs {
            d.push(minus(
                &stage.vertex(scene, a, i, &span)?,
                &stage.vertex(scene, b, j, &span)?,
            )?);
        }
        let mut volumes = Vec::new();
        for k in 0..4 {
            let [x, y, z] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]][k];
            volumes.push(dot(&d[x], &cross(&d[y], &d[z])?)?.sign());
        }
        let sign = |i: usize, j: usize, k: usize| volumes[6 - i - j - k];
        Some(enclose(sign, false))
    }
}
