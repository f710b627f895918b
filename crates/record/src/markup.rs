//! Text in HTML, SVG and XML.

use std::fmt::Write as _;

/// Returns a text for the content or a quoted attribute of an element of HTML, SVG or XML.
///
/// ```
/// let name = lin_canny_record::escaped("<tool> & \"post\"");
/// assert_eq!(name, "&lt;tool&gt; &amp; &quot;post&quot;");
/// ```
#[must_use]
pub fn escaped(text: &str) -> String {
    let mut all = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => all.push_str("&amp;"),
            '<' => all.push_str("&lt;"),
            '>' => all.push_str("&gt;"),
            '"' => all.push_str("&quot;"),
            // In an attribute these would be read as spaces.
            '\n' | '\r' | '\t' => {
                let _ = write!(all, "&#{};", u32::from(c));
            }
            _ => all.push(c),
        }
    }
    all
}
