//! Names that become parts of paths: of experiments, sessions, graphs, steps, methods and parameters.

use anyhow::bail;

/// The longest name, in bytes: file systems allow 255 for a file, and files add endings.
const LONGEST: usize = 180;

/// What a name may have beside letters and digits.
const MARKS: &str = "._+-=~@()' ";

/// Refuses a name that is no single part of a path, or that a shell or a list separated by commas would take apart.
pub(crate) fn check(what: &str, name: &str) -> anyhow::Result<()> {
    check_value(what, name)?;
    let starts_well = name.starts_with(|first: char| first.is_alphanumeric() || first == '_');
    if !starts_well || name.ends_with(' ') {
        bail!("{what} \"{}\" cannot be used as a name; start it with a letter or a digit", shown(name));
    }
    Ok(())
}

/// The same for a parameter's value, which follows the parameter's name in a path: it may be empty or start with a sign.
pub(crate) fn check_value(what: &str, value: &str) -> anyhow::Result<()> {
    let allowed = |character: &char| character.is_alphanumeric() || MARKS.contains(*character);
    if let Some(wrong) = value.chars().find(|character| !allowed(character)) {
        bail!(
            "{what} \"{}\" contains {wrong:?}, and becomes part of a path; use letters, digits and {MARKS}",
            shown(value)
        );
    }
    if value.len() > LONGEST {
        bail!(
            "{what} \"{}\" is {} bytes long, and becomes part of a path; use at most {LONGEST}",
            shown(value),
            value.len()
        );
    }
    Ok(())
}

/// A name as messages show it: in one line, shortened.
pub(crate) fn shown(name: &str) -> String {
    const SHOWN: usize = 60;
    let escaped: String = name.chars().take(SHOWN).flat_map(char::escape_debug).collect();
    if name.chars().nth(SHOWN).is_some() { format!("{escaped}…") } else { escaped }
}
