//! `cargo xtask licences`: every crate that programs and tests are built from, with its version and licence.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::process::{Command, Stdio};

use anyhow::{Context as _, bail};
use clap::Args;
use serde::Deserialize;
use spdx::{Expression, Licensee, ParseMode};
use xtask::workspace::root;

use crate::Verdict;

/// Write docs/dependencies.md: every dependency with its version and licence
///
/// Fails if a licence is not among those that deny.toml allows, or if a crate does not come from the registry.
#[derive(Args)]
pub(crate) struct Licences {
    /// Write nothing, and fail if the page is out of date
    #[arg(long)]
    check: bool,
}

const PAGE: &str = "docs/dependencies.md";

/// The fields of `cargo metadata` that matter here.
#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
    workspace_members: HashSet<String>,
    resolve: Resolve,
}

#[derive(Deserialize)]
struct Package {
    id: String,
    name: String,
    version: String,
    license: Option<String>,
    source: Option<String>,
    /// The registries to which it may be published; empty for `publish = false`.
    publish: Option<Vec<String>>,
}

#[derive(Deserialize)]
struct Resolve {
    nodes: Vec<Node>,
}

#[derive(Deserialize)]
struct Node {
    id: String,
    deps: Vec<Dependency>,
}

#[derive(Deserialize)]
struct Dependency {
    pkg: String,
    dep_kinds: Vec<Kind>,
}

#[derive(Deserialize)]
struct Kind {
    kind: Option<String>,
}

impl Licences {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let (text, mut problems) = page(&metadata()?, &allowed()?);
        let path = root().join(PAGE);
        if !self.check {
            std::fs::write(&path, text).with_context(|| format!("{PAGE}: cannot be written"))?;
        } else if std::fs::read_to_string(&path).ok() != Some(text) {
            problems.push(format!("{PAGE} is out of date; run `cargo xtask licences` and commit the result"));
        }
        for problem in &problems {
            eprintln!("licences: {problem}");
        }
        Ok(if problems.is_empty() { Verdict::Holds } else { Verdict::Fails })
    }
}

fn metadata() -> anyhow::Result<Metadata> {
    let mut command = Command::new("cargo");
    command.args(["metadata", "--format-version", "1", "--locked"]).current_dir(root());
    let output = command.stderr(Stdio::inherit()).output().context("cargo cannot be started")?;
    if !output.status.success() {
        bail!("`cargo metadata` failed; see its message above");
    }
    serde_json::from_slice(&output.stdout).context("the output of `cargo metadata` cannot be used")
}

/// The licences that deny.toml allows; cargo-deny uses the same list.
fn allowed() -> anyhow::Result<Vec<Licensee>> {
    #[derive(Deserialize)]
    struct Deny {
        licenses: Allowed,
    }
    #[derive(Deserialize)]
    struct Allowed {
        allow: Vec<String>,
    }
    let text = std::fs::read_to_string(root().join("deny.toml")).context("deny.toml: cannot be read")?;
    let deny: Deny = toml::from_str(&text).context("deny.toml: has no list `allow` under [licenses]")?;
    let licensee = |name: &String| {
        Licensee::parse(name).with_context(|| format!("deny.toml: \"{name}\" is not a licence of SPDX"))
    };
    deny.licenses.allow.iter().map(licensee).collect()
}

/// Whether an expression is allowed: any licence of an OR, all of an AND. Some crates write `/` for OR.
fn is_allowed(expression: &str, allowed: &[Licensee]) -> bool {
    let parsed = Expression::parse_mode(expression, ParseMode::LAX);
    parsed.is_ok_and(|parsed| {
        parsed.evaluate(|requirement| allowed.iter().any(|licensee| licensee.satisfies(requirement)))
    })
}

/// The packages that programs are built from: those that published crates reach without development dependencies.
fn linked(metadata: &Metadata) -> HashSet<&str> {
    let nodes: HashMap<&str, &Node> = metadata.resolve.nodes.iter().map(|node| (&*node.id, node)).collect();
    let published = |package: &&Package| {
        metadata.workspace_members.contains(&package.id)
            && package.publish.as_ref().is_none_or(|to| !to.is_empty())
    };
    let mut open: Vec<&str> =
        metadata.packages.iter().filter(published).map(|package| package.id.as_str()).collect();
    let mut seen = HashSet::new();
    while let Some(id) = open.pop() {
        if !seen.insert(id) {
            continue;
        }
        let dependencies = nodes.get(id).map(|node| node.deps.as_slice()).unwrap_or_default();
        let built = |dependency: &&Dependency| {
            dependency.dep_kinds.iter().any(|kind| kind.kind.as_deref() != Some("dev"))
        };
        open.extend(dependencies.iter().filter(built).map(|dependency| dependency.pkg.as_str()));
    }
    seen
}

/// The text of the page, and the problems with the dependencies.
fn page(metadata: &Metadata, allowed: &[Licensee]) -> (String, Vec<String>) {
    let linked = linked(metadata);
    let (mut rows, mut problems) = (BTreeMap::new(), Vec::new());
    let foreign = |package: &&Package| !metadata.workspace_members.contains(&package.id);
    for package in metadata.packages.iter().filter(foreign) {
        let Package { id, name, version, .. } = package;
        let licence = package.license.as_deref().unwrap_or_default();
        if !is_allowed(licence, allowed) {
            problems.push(format!("{name} {version}: its licence \"{licence}\" is not allowed by deny.toml"));
        }
        let source = package.source.as_deref().unwrap_or("a folder");
        if !source.starts_with("registry+") {
            problems.push(format!("{name} {version}: comes from {source}, not from the registry"));
        }
        let used = if linked.contains(id.as_str()) { "programs" } else { "tests" };
        rows.insert((name, version), format!("| {name} | {version} | {licence} | {used} |\n"));
    }
    let text = format!(
        "# Dependencies and their licences\n\n\
         Made by `cargo xtask licences` from Cargo.lock, for all platforms. It fails if a licence is not allowed.\n\
         *programs*: the programs contain this crate. *tests*: only tests, benches and `xtask` do. `deny.toml` lists the\n\
         allowed licences, so that `cargo deny check` (cargo-deny 0.20) agrees. `scripts/check-advisories.sh` checks\n\
         Cargo.lock against security advisories if cargo-deny or cargo-audit is installed, and reports if it cannot.\n\n\
         {} crates.\n\n| crate | version | licence | used by |\n|---|---|---|---|\n{}",
        rows.len(),
        rows.into_values().collect::<String>()
    );
    (text, problems)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions_are_met_by_any_of_an_or_and_all_of_an_and() {
        let allowed = allowed().unwrap();
        for good in [
            "MIT",
            "MIT OR GPL-3.0-only",
            "MIT/Apache-2.0",
            "(MIT OR GPL-3.0-only) AND Unicode-3.0",
            "Apache-2.0 WITH LLVM-exception",
        ] {
            assert!(is_allowed(good, &allowed), "{good}");
        }
        for bad in
            ["", "GPL-3.0-only", "MIT AND GPL-3.0-only", "GPL-2.0-only WITH Classpath-exception-2.0", "Own"]
        {
            assert!(!is_allowed(bad, &allowed), "{bad}");
        }
    }

    #[test]
    fn development_dependencies_are_of_tests_and_foreign_sources_are_problems() {
        let text = r#"{"workspace_members": ["own", "tests"],
            "packages": [
                {"id": "own", "name": "own", "version": "1.0.0", "license": "MIT", "source": null, "publish": null},
                {"id": "tests", "name": "tests", "version": "1.0.0", "license": "MIT", "source": null, "publish": []},
                {"id": "b", "name": "b", "version": "2.0.0", "license": "MIT", "source": "registry+x", "publish": null},
                {"id": "a", "name": "a", "version": "1.0.0", "license": "Own", "source": "git+x", "publish": null}],
            "resolve": {"nodes": [
                {"id": "own", "deps": [{"pkg": "b", "dep_kinds": [{"kind": null}]}, {"pkg": "a", "dep_kinds": [{"kind": "dev"}]}]},
                {"id": "tests", "deps": [{"pkg": "a", "dep_kinds": [{"kind": null}]}]}]}}"#;
        let (page, problems) = page(&serde_json::from_str(text).unwrap(), &allowed().unwrap());
        assert!(page.ends_with("| a | 1.0.0 | Own | tests |\n| b | 2.0.0 | MIT | programs |\n"), "{page}");
        assert_eq!(problems.len(), 2, "{problems:?}");
        assert!(problems[0].contains("\"Own\"") && problems[1].contains("git+x"), "{problems:?}");
    }
}
