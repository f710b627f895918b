//! Suggests the name that was meant by a misspelt one.

/// The longest name, in letters, that gets a suggestion.
const LONGEST: usize = 100;

/// Returns the name that is closest to a wrong one, if one is close.
///
/// Blanks at the ends and the case of letters do not count.
#[must_use]
pub fn nearest_name<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> Option<Box<str>> {
    let letters = |name: &str| -> Vec<char> { name.trim().to_lowercase().chars().take(LONGEST + 1).collect() };
    let wrong = letters(wrong);
    let most = (wrong.len() + 1) / 3;
    let near = |name: &'a str| {
        let name_letters = letters(name);
        let is_long = wrong.len().max(name_letters.len()) > LONGEST;
        let is_close = wrong.len().abs_diff(name_letters.len()) <= most;
        let edits = (is_close && !is_long).then(|| strsim::generic_levenshtein(&wrong, &name_letters))?;
        (edits <= most).then_some((edits, name))
    };
    let found = names.into_iter().filter_map(near).min_by_key(|(edits, _)| *edits);
    found.map(|(_, name)| name.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_suggested_if_it_is_close() {
        let names = ["base_link", "tool", "forearm", "upper_arm"];
        let near = |wrong: &str| nearest_name(wrong, names);
        assert_eq!(near("base_lnik").as_deref(), Some("base_link"));
        assert_eq!(near(" Base_Link ").as_deref(), Some("base_link"));
        assert_eq!(near("foream").as_deref(), Some("forearm"));
        assert_eq!(near("tools").as_deref(), Some("tool"));
        assert_eq!(near("gripper"), None);
        assert_eq!(near(""), None);
        assert_eq!(nearest_name("x", ["a", "b"]), None);
        assert_eq!(nearest_name(&"x".repeat(1_000_000), [&*"x".repeat(1_000_000)]), None);
    }
}
