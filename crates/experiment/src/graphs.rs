//! Graphs that a declaration gives as files.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use serde::{Deserialize, Deserializer};

/// Formats that posecut-convert reads as graphs.
const EXTENSIONS: &[&str] = &["g2o", "graph", "toro", "jsonl"];

/// Some graphs with a source of labels.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Graphs {
    /// One or several patterns with `*` and `?` for files below the folder of data. A folder is one graph: its files are joined.
    #[serde(deserialize_with = "patterns")]
    pub files: Vec<String>,
    /// The names of the graphs. `{stem}` is the file's name without its extension.
    #[serde(default = "stem")]
    pub name: String,
    /// Options of the step `label`, after those of `[stages]`. `{folder}` is the file's folder, `{data}` the folder of all data.
    #[serde(default)]
    pub label: String,
    /// Options of the step `convert`, with the same replacements.
    #[serde(default)]
    pub convert: String,
    /// The unit of the bootstrap, if several graphs are variants of one. By default the name of the graph.
    pub cluster: Option<String>,
    /// Where to get these files, for the message that they are missing.
    pub from: Option<String>,
}

fn patterns<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<String>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Patterns {
        One(String),
        Several(Vec<String>),
    }
    Ok(match Patterns::deserialize(deserializer)? {
        Patterns::One(pattern) => vec![pattern],
        Patterns::Several(patterns) => patterns,
    })
}

fn stem() -> String {
    "{stem}".to_owned()
}

/// One graph.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GraphFile {
    pub(crate) name: String,
    pub(crate) cluster: String,
    /// The file of the graph, or all files to join.
    pub(crate) files: Vec<String>,
    /// Options of the steps, with paths in place of `{folder}`, `{stem}` and `{data}`.
    pub(crate) convert: Vec<String>,
    pub(crate) label: Vec<String>,
}

impl Graphs {
    /// The existing graphs, in order of their paths. It is an error if there is none.
    pub(crate) fn find(&self, data: &Path) -> anyhow::Result<Vec<GraphFile>> {
        let mut paths = BTreeSet::new();
        for files in &self.files {
            let pattern = format!("{}/{files}", glob::Pattern::escape(&data.to_string_lossy()));
            let found = glob::glob(&pattern)
                .with_context(|| format!("graphs, files = \"{files}\": is not a pattern of file names"))?
                .collect::<Result<Vec<PathBuf>, _>>()
                .with_context(|| format!("{}: cannot be listed", data.display()))?;
            if found.is_empty() {
                let from = self.from.as_ref().map(|from| format!(" ({from})")).unwrap_or_default();
                bail!(
                    "{}: has no {files}{from}; put the files there, or name the folder that has them with --data",
                    data.display()
                );
            }
            paths.extend(found);
        }
        paths.iter().map(|path| self.graph(data, path)).collect()
    }

    fn graph(&self, data: &Path, path: &Path) -> anyhow::Result<GraphFile> {
        let text = |path: &Path| path.to_string_lossy().into_owned();
        // Do not use `file_stem` for a folder, whose name may contain a dot.
        let stem = if path.is_dir() { path.file_name() } else { path.file_stem() };
        let stem = stem.map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let folder = text(path.parent().unwrap_or(data));
        let fill = |word: &str| {
            word.replace("{folder}", &folder).replace("{stem}", &stem).replace("{data}", &text(data))
        };
        let words = |options: &str| options.split_whitespace().map(fill).collect();
        let name = self.name.replace("{stem}", &stem);
        Ok(GraphFile {
            cluster: self.cluster.clone().unwrap_or_else(|| name.clone()),
            name,
            files: if path.is_dir() { members(path)? } else { vec![text(path)] },
            convert: words(&self.convert),
            label: words(&self.label),
        })
    }
}

/// The graph files of a folder; numbered ones in the order of their numbers.
fn members(folder: &Path) -> anyhow::Result<Vec<String>> {
    let place = || format!("{}: cannot be listed", folder.display());
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .with_context(place)?
        .map(|entry| Ok(entry?.path()))
        .collect::<std::io::Result<_>>()
        .with_context(place)?;
    paths.retain(|path| {
        path.extension().is_some_and(|extension| EXTENSIONS.iter().any(|known| extension == *known))
    });
    paths.sort_by_cached_key(|path| {
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        (stem.parse::<u64>().unwrap_or(u64::MAX), stem)
    });
    if paths.is_empty() {
        bail!("{}: contains no graph (.{})", folder.display(), EXTENSIONS.join(", ."));
    }
    Ok(paths.iter().map(|path| path.to_string_lossy().into_owned()).collect())
}
