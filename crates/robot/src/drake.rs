//! Elements that Drake adds to URDF: pairs that are not checked, shapes, hulls.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use roxmltree::Node;

use crate::error::{FileError, FileErrorKind};
use crate::groups::nested;
use crate::xml::{Xml, attribute};
use lin_canny_plan::nearest_name as nearest;

/// Elements of Drake without geometry or kinematics.
const PASSED: [&str; 15] = [
    "drake:acceleration",
    "drake:accepting_renderer",
    "drake:controller_gains",
    "drake:damping",
    "drake:diffuse_map",
    "drake:effort",
    "drake:gear_ratio",
    "drake:illustration_properties",
    "drake:linear_bushing_rpy",
    "drake:linear_spring_damper",
    "drake:perception_properties",
    "drake:proximity_properties",
    "drake:rotor_inertia",
    "drake:velocity",
    "drake:visual",
];

/// Elements of Drake that move links or tie joints to each other.
const KINEMATIC: [&str; 5] = [
    "drake:ball_constraint",
    "drake:deformable_properties",
    "drake:joint",
    "drake:mimic",
    "drake:tendon_constraint",
];

/// The elements of a group.
const PARTS: &[&str] = &[
    "drake:member",
    "drake:member_group",
    "drake:ignored_collision_filter_group",
];

/// Returns the elements of Drake below another element that are read, in their order.
///
/// Any other element of Drake is an error, unless it has neither geometry nor kinematics.
pub(crate) fn below<'n, 'a>(
    xml: &Xml<'a>,
    parent: Node<'n, 'a>,
    read: &'static [&'static str],
) -> Result<Vec<Node<'n, 'a>>, FileError> {
    let mut found = Vec::new();
    for node in parent.children().filter(|node| xml.is_of_drake(node)) {
        let name = format!("drake:{}", node.tag_name().name());
        if read.contains(&&*name) {
            found.push(node);
        } else if KINEMATIC.contains(&&*name) {
            return Err(xml.error(&node, FileErrorKind::Unsupported(name)));
        } else if !PASSED.contains(&&*name) {
            let (what, expected) = ("element", read);
            return Err(xml.error(&node, FileErrorKind::UnknownPart { what, name, expected }));
        }
    }
    Ok(found)
}

/// The elements of a group `drake:collision_filter_group`.
#[derive(Default)]
struct Group {
    links: BTreeSet<usize>,
    inner: Vec<usize>,
    ignored: Vec<usize>,
}

/// Returns the pairs of links that the groups of a robot exclude, the smaller number first.
pub(crate) fn excluded<'a>(
    xml: &Xml<'a>,
    nodes: &[Node<'_, 'a>],
    links: &HashMap<&str, usize>,
) -> Result<BTreeSet<[usize; 2]>, FileError> {
    let mut read = Vec::new();
    for node in nodes {
        match attribute(node, "ignore") {
            Some("true") => {}
            None | Some("false") => read.push(*node),
            Some(other) => {
                let reason = format!("invalid ignore: {other:?} (expected true or false)");
                return Err(xml.error(node, FileErrorKind::Malformed(reason)));
            }
        }
    }
    let links: BTreeMap<&str, usize> = links.iter().map(|(name, k)| (*name, *k)).collect();
    let mut numbers = BTreeMap::new();
    for (k, node) in read.iter().enumerate() {
        if numbers.insert(xml.needed(node, "name")?, k).is_some() {
            return Err(xml.error(node, FileErrorKind::Repeated));
        }
    }
    let mut groups = Vec::new();
    for node in &read {
        xml.below(*node, &[], &[])?;
        let mut group = Group::default();
        for part in below(xml, *node, PARTS)? {
            match part.tag_name().name() {
                "member" => {
                    group.links.insert(number(xml, part, "link", &["link"], &links)?);
                }
                "member_group" => group.inner.push(number(xml, part, "group", &["name"], &numbers)?),
                _ => group.ignored.push(number(xml, part, "group", &["name"], &numbers)?),
            }
        }
        groups.push(group);
    }
    let inner: Vec<Vec<usize>> = groups.iter().map(|group| group.inner.clone()).collect();
    let members = |k: usize| -> BTreeSet<usize> {
        let inside = nested(k, &inner);
        let all = inside.keys().chain([&k]);
        all.flat_map(|k| &groups[*k].links).copied().collect()
    };
    let mut pairs = BTreeSet::new();
    for (k, group) in groups.iter().enumerate() {
        for &other in &group.ignored {
            let others = members(other);
            for a in members(k) {
                let apart = others.iter().filter(|b| a != **b);
                pairs.extend(apart.map(|&b| [a.min(b), a.max(b)]));
            }
        }
    }
    Ok(pairs)
}

/// Returns the number of the name in the only attribute of an element.
fn number(
    xml: &Xml,
    node: Node,
    kind: &'static str,
    field: &'static [&'static str; 1],
    numbers: &BTreeMap<&str, usize>,
) -> Result<usize, FileError> {
    xml.check_leaf(node, field, false)?;
    let name = xml.needed(&node, field[0])?;
    numbers.get(name).copied().ok_or_else(|| {
        let near = nearest(name, numbers.keys().copied());
        let name = name.into();
        xml.error(&node, FileErrorKind::Unknown { kind, name, near })
    })
}
