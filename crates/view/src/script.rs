//! Scripts of pages: what several pages share, and how a page carries its scripts.

use crate::encode::policy_digest;

/// Decodes the series of [`crate::encode`].
pub const SERIES: &str = include_str!("../assets/script/series.js");

/// Makes elements whose text is never markup.
pub const ELEMENTS: &str = include_str!("../assets/script/elements.js");

/// Scales of axes, and numbers as text.
pub const SCALE: &str = include_str!("../assets/script/scale.js");

/// Scripts in the order in which they run, wrapped in one function, so that they define no global names.
pub fn wrapped(scripts: &[&str]) -> String {
    format!("\"use strict\";\n(() => {{\n{}}})();\n", scripts.join("\n"))
}

/// A content security policy that forbids every connection, every style but this and every script but this.
pub fn policy(style: &str, script: &str) -> String {
    format!(
        "default-src 'none'; style-src {}; script-src {}; base-uri 'none'; form-action 'none'",
        policy_digest(style),
        policy_digest(script)
    )
}
