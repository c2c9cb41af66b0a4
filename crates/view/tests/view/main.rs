//! The tests of pages, in one program: linking takes longer than most of them.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod graphs;
mod maps;
mod program;
mod safety;
mod statistics;

use posecut_view::{View, page};
use serde_json::Value;

/// The data of a page, as its script reads it.
fn data(page: &str) -> Value {
    let start = page.find("id=\"data\">").unwrap() + "id=\"data\">".len();
    let end = start + page[start..].find("</script>").unwrap();
    serde_json::from_str(&page[start..end]).unwrap()
}

/// The data of the page of a view.
fn data_of(view: &View) -> Value {
    data(&page(view).unwrap())
}
