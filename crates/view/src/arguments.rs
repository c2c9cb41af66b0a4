//! The arguments of a stage as text, from its entry in the provenance.

use serde_json::Value;

/// Arguments as names and values for a reader. Arguments that were not given are left out. So is the seed, because the
/// entry lists all seeds.
pub fn said(arguments: &Value) -> String {
    let mut shown = Vec::new();
    list("", arguments, &mut shown);
    shown.join(", ")
}

fn list(name: &str, value: &Value, shown: &mut Vec<String>) {
    match value {
        Value::Null => {}
        Value::Object(fields) => {
            for (field, value) in fields.iter().filter(|(field, _)| field.as_str() != "seed") {
                let full = if name.is_empty() { field.clone() } else { format!("{name}.{field}") };
                list(&full, value, shown);
            }
        }
        Value::String(text) => shown.push(format!("{name} = {text}")),
        other => shown.push(format!("{name} = {other}")),
    }
}
