//! What is proved against the constants.

use lin_canny::__proofs::constants;
use proofs::bounds::{self, Allowed, Bound};

use crate::table::of_planner;

/// What the constant, or its derivation, allows.
pub(crate) fn allowed(bound: &Bound) -> f64 {
    let all: Vec<_> = constants().into_iter().chain(of_planner()).collect();
    let value = |name: &str| {
        let found = all.iter().find(|(n, _)| *n == name);
        found.unwrap_or_else(|| panic!("no constant {name}")).1
    };
    match bound.allowed {
        Allowed::Constant => value(bound.constant),
        Allowed::Sum(of) => of.iter().map(|(count, name)| count * value(name)).sum(),
        Allowed::Part(of) => {
            assert!(of <= value(bound.constant), "{} {}", bound.constant, bound.part);
            of
        }
    }
}

#[test]
fn every_constant_covers_what_is_proved() {
    let mut short = Vec::new();
    for bound in bounds::all() {
        let (proved, allowed) = (bound.proved.to_f64().value(), allowed(&bound));
        println!("{:18} {:26} {proved:9.4} of {allowed:9.4}", bound.constant, bound.part);
        if bound.proved > truth::rational::exact(allowed) {
            short.push(format!("{} {}: {proved} of {allowed}", bound.constant, bound.part));
        }
    }
    assert!(short.is_empty(), "not covered:\n  {}", short.join("\n  "));
}
