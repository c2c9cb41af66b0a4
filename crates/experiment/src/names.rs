//! Checks names that become parts of paths: of experiments, sessions, graphs, steps, methods and parameters.

use anyhow::bail;

/// The longest name, in bytes. File systems allow 255 for a file name, and endings are added to the name.
const LONGEST: usize = 180;

/// The characters that a name may contain in addition to letters and digits.
const MARKS: &str = "._+-=~@()' ";

/// Refuses a name that is not a single part of a path, or that a shell or a comma-separated list would split.
pub(crate) fn check(what: &str, name: &str) -> anyhow::Result<()> {
    check_value(what, name)?;
    let starts_well = name.starts_with(|first: char| first.is_alphanumeric() || first == '_');
    if !starts_well || name.ends_with(' ') {
        bail!("{what} \"{}\" cannot be used as a name; start it with a letter or a digit", shown(name));
    }
    Ok(())
}

/// Checks a parameter's value in the same way. The value follows the parameter's name in a path, so it may be empty or start
/// with a sign.
pub(crate) fn check_value(what: &str, value: &str) -> anyhow::Result<()> {
    let allowed = |character: &char| character.is_alphanumeric() || MARKS.contains(*character);
    if let Some(wrong) = value.chars().find(|character| !allowed(character)) {
        bail!(
            "{what} \"{}\" contains {wrong:?}, but becomes part of a path; use only letters, digits and {MARKS}",
            shown(value)
        );
    }
    if value.len() > LONGEST {
        bail!(
            "{what} \"{}\" is {} bytes long, but becomes part of a path; use at most {LONGEST} bytes",
            shown(value),
            value.len()
        );
    }
    Ok(())
}

/// A name for messages: on one line and shortened.
pub(crate) fn shown(name: &str) -> String {
    const SHOWN: usize = 60;
    let escaped: String = name.chars().take(SHOWN).flat_map(char::escape_debug).collect();
    if name.chars().nth(SHOWN).is_some() { format!("{escaped}…") } else { escaped }
}
