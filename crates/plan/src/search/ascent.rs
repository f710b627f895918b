//! Ascent of the clearance within a slice: steps along the gradients of the active set.
//!
//! The clearance is the least signed distance of all pairs. It has a kink if two pairs are equally
//! close, or if the witness of one pair jumps (parallel faces). Its maxima are at kinks. So a step
//! uses a model of the clearance: the least of several linear bounds `c + g . z` in the step z. The
//! bounds are those of the pairs that are nearly closest at the centre, and those of configurations
//! that were tried without gain. The step maximises the model less `|z|^2 / (2 mu)` (proximal
//! bundle method: Lemarechal 1978, Kiwiel 1990). The dual problem is a quadratic over a simplex. It
//! is solved by exchanges between two weights.

use std::vec::Vec;

use crate::check::checker::Checker;
use crate::check::clearance::NearPair;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::space::ConfigurationSpace;

/// Maximum number of steps of an ascent.
const ASCENT: usize = 96;

/// Gain of a step, divided by the length of the trust region, below which the clearance counts as
/// stationary.
const FLAT: f64 = 1.0 / 256.0;

/// Fraction of the expected gain that a step must reach.
const GOOD: f64 = 1.0 / 8.0;

/// Maximum number of pairs that count at one configuration: twice as many bounds as determine a
/// maximum in six dimensions.
const PLANES: usize = 12;

/// Maximum number of exchanges between two weights in the search for a step. Of random models with
/// six planes, 2 % are not within a thousandth of their maximum after 64 exchanges, 0.2 % after
/// 256.
const EXCHANGES: usize = 256;

/// A configuration and its clearance.
#[derive(Clone, Debug)]
pub(crate) struct ClearConfiguration {
    pub(crate) q: Vec<f64>,
    pub(crate) distance: f64,
    /// The pairs that are nearly closest, the closest first.
    near: Vec<ClearancePlane>,
}

/// A linear bound of the clearance around a configuration: a value, and a gradient by scaled steps.
#[derive(Clone, Debug)]
struct ClearancePlane {
    value: f64,
    gradient: Vec<f64>,
}

/// The components of a step that stay zero, and the lengths of steps.
#[derive(Clone, Debug)]
pub(crate) struct Slice {
    pub(crate) fixed: Vec<bool>,
    /// The longest step, and the shortest step that is tried.
    pub(crate) longest: f64,
    pub(crate) shortest: f64,
    /// The clearance at which an ascent ends.
    pub(crate) clearance_cap: f64,
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Measures a configuration. The clearance of a cell without pairs is infinite.
    ///
    /// If pairs must keep different distances, the clearance is the least excess over them, plus
    /// the margin.
    pub(crate) fn place(&mut self, q: Vec<f64>, slack: f64) -> Result<ClearConfiguration, PlanError> {
        let is_uniform = self.pairs.is_uniform;
        let spread = if is_uniform { 0.0 } else { self.pairs.spread() };
        let (margin, scales) = (self.cell.margin(), self.space.scales().to_vec());
        let near = self.nearest(&q, slack + spread)?;
        let value = |near: &NearPair| {
            if is_uniform {
                near.distance
            } else {
                near.excess + margin
            }
        };
        let planes = near.iter().map(|near| ClearancePlane {
            value: value(near),
            gradient: near.scaled_gradient(&scales),
        });
        let mut near: Vec<ClearancePlane> = planes.collect();
        if !is_uniform {
            near.sort_by(|x, y| x.value.total_cmp(&y.value));
        }
        let distance = near.first().map_or(f64::INFINITY, |n| n.value);
        Ok(ClearConfiguration { q, distance, near })
    }

    /// Ascends within a slice and returns the configurations passed. The last one is a local
    /// maximum of the clearance, up to the precision of the slice.
    pub(crate) fn ascend(&mut self, start: Vec<f64>, slice: &Slice) -> Result<Vec<ClearConfiguration>, PlanError> {
        let mut centre = self.place(start, slice.longest)?;
        let mut mu = (0.5 * centre.distance.abs()).clamped(slice.shortest * 4.0, slice.longest);
        let mut passed = Vec::new();
        let mut planes = planes_at(&centre, mu);
        let mut own = planes.len();
        for _ in 0..ASCENT {
            if centre.distance >= slice.clearance_cap {
                break;
            }
            let (step, gain) = self.step(&centre, &planes, mu, slice);
            if gain <= FLAT * mu {
                if mu <= 4.0 * slice.shortest {
                    break;
                }
                mu *= 0.25;
                planes = planes_at(&centre, mu);
                own = planes.len();
                continue;
            }
            let tried = self.place(self.space.moved(&centre.q, &step), mu)?;
            if tried.distance >= centre.distance + GOOD * gain {
                mu = (2.0 * mu).smaller(slice.longest);
                planes = planes_at(&tried, mu);
                own = planes.len();
                passed.push(core::mem::replace(&mut centre, tried));
                continue;
            }
            self.learn(&mut planes, &centre, &tried, own);
            mu *= 0.5;
            if mu < slice.shortest {
                break;
            }
        }
        passed.push(centre);
        Ok(passed)
    }

    /// Returns the step that maximises the model, and the gain of the model. Components that would
    /// leave the bounds are zero.
    fn step(&self, centre: &ClearConfiguration, planes: &[ClearancePlane], mu: f64, slice: &Slice) -> (Vec<f64>, f64) {
        let mut fixed = slice.fixed.clone();
        loop {
            let (z, least) = maximum(planes, mu, &fixed);
            let is_out = |k: usize| {
                let [low, high] = self.space.bounds()[k];
                !fixed[k] && ((z[k] < 0.0 && centre.q[k] <= low) || (z[k] > 0.0 && centre.q[k] >= high))
            };
            match (0..self.space.bounds().len()).find(|&k| is_out(k)) {
                Some(k) => fixed[k] = true,
                None => {
                    let step = z.iter().zip(self.space.scales()).map(|(x, s)| x / s);
                    return (step.collect(), least - centre.distance);
                }
            }
        }
    }

    /// Adds the bounds of a configuration that was tried without gain.
    fn learn(
        &self,
        planes: &mut Vec<ClearancePlane>,
        centre: &ClearConfiguration,
        tried: &ClearConfiguration,
        own: usize,
    ) {
        let step = self.space.difference(&centre.q, &tried.q);
        let z: Vec<f64> = step.iter().zip(self.space.scales()).map(|(x, s)| x * s).collect();
        for near in tried.near.iter().take(PLANES) {
            let value = near.value - dot(&near.gradient, &z);
            // The clearance is not concave: a plane below the value at the centre is no bound.
            planes.push(ClearancePlane {
                value: value.larger(centre.distance),
                gradient: near.gradient.clone(),
            });
        }
        // Remove the oldest learned planes. The planes of the centre come first and are kept.
        let extra = planes.len().saturating_sub(own + 4 * PLANES);
        planes.drain(own..own + extra);
    }
}

fn planes_at(place: &ClearConfiguration, mu: f64) -> Vec<ClearancePlane> {
    let within = place.near.iter().take(PLANES);
    let within = within.filter(|near| near.value <= place.distance + 4.0 * mu);
    within.cloned().collect()
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Returns the z that maximises the least plane less `|z|^2 / (2 mu)`, and the value of the least
/// plane there.
fn maximum(planes: &[ClearancePlane], mu: f64, fixed: &[bool]) -> (Vec<f64>, f64) {
    let free = |g: &[f64]| -> Vec<f64> {
        let parts = g.iter().zip(fixed);
        parts.map(|(x, is_fixed)| if *is_fixed { 0.0 } else { *x }).collect()
    };
    let gradients: Vec<Vec<f64>> = planes.iter().map(|p| free(&p.gradient)).collect();
    let lowest = (0..planes.len()).min_by(|&i, &j| planes[i].value.total_cmp(&planes[j].value));
    let Some(first) = lowest else {
        return (std::vec![0.0; fixed.len()], f64::INFINITY);
    };
    // Products of the gradients, so that the cost of an exchange is linear in the number of planes.
    let products: Vec<Vec<f64>> = gradients
        .iter()
        .map(|g| gradients.iter().map(|h| dot(g, h)).collect())
        .collect();
    let mut weights = std::vec![0.0; planes.len()];
    weights[first] = 1.0;
    let of_first = planes.iter().zip(&products[first]);
    let mut values: Vec<f64> = of_first.map(|(p, product)| p.value + mu * product).collect();
    exchange(&mut weights, &mut values, &products, mu);
    let of = |k: usize| gradients.iter().zip(&weights).map(move |(g, w)| mu * w * g[k]).sum();
    let z: Vec<f64> = (0..fixed.len()).map(of).collect();
    let least = planes.iter().zip(&gradients).map(|(p, g)| p.value + dot(g, &z));
    let least = least.fold(f64::INFINITY, f64::smaller);
    (z, least)
}

/// Moves weight from the plane with the highest value to the plane with the lowest, until all
/// planes with a weight have equal values. A value is that of a plane after the step of the
/// weights.
fn exchange(weights: &mut [f64], values: &mut [f64], products: &[Vec<f64>], mu: f64) {
    for _ in 0..EXCHANGES {
        let by_value = |i: &usize, j: &usize| values[*i].total_cmp(&values[*j]);
        let weighty = (0..values.len()).filter(|&k| weights[k] > 0.0);
        let (Some(low), Some(high)) = ((0..values.len()).min_by(by_value), weighty.max_by(by_value)) else {
            break;
        };
        let gap = values[high] - values[low];
        let square = products[low][low] - 2.0 * products[low][high] + products[high][high];
        if !(gap > FLAT * FLAT * mu && square > 0.0) {
            break;
        }
        let part = (gap / (mu * square)).smaller(weights[high]);
        weights[high] -= part;
        weights[low] += part;
        for (k, value) in values.iter_mut().enumerate() {
            *value += mu * part * (products[low][k] - products[high][k]);
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use truth::rng::Rng;

    /// Compares with a search: the penalised model is concave, so no point of a fine grid around
    /// the result may be better.
    #[test]
    fn the_step_maximises_the_model() {
        let mut rng = Rng::new(5);
        for _ in 0..300 {
            let planes: Vec<ClearancePlane> = (0..1 + rng.below(6))
                .map(|_| ClearancePlane {
                    value: rng.range(0.0, 0.3),
                    gradient: (0..2).map(|_| rng.range(-1.0, 1.0)).collect(),
                })
                .collect();
            let mu = rng.range(0.1, 2.0);
            let worth = |z: &[f64]| {
                let least = planes.iter().map(|p| p.value + dot(&p.gradient, z));
                least.fold(f64::INFINITY, f64::min) - dot(z, z) / (2.0 * mu)
            };
            let (z, _) = maximum(&planes, mu, &[false, false]);
            let best = worth(&z);
            for i in -40..=40 {
                for j in -40..=40 {
                    let other = [z[0] + f64::from(i) * 0.02, z[1] + f64::from(j) * 0.02];
                    assert!(worth(&other) <= best + 2e-2 * mu, "{z:?} {other:?}");
                }
            }
        }
    }
}
