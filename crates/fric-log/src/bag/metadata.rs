//! `metadata.yaml`: the files of a bag and their compression.

use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};
use std::{fs, io};

use fric_core::text_file;
use saphyr::{LoadableYamlNode, Yaml};

/// The file that the recorder writes when it ends.
const METADATA: &str = "metadata.yaml";
/// File extensions of a bag's files.
const ENDINGS: [&str; 2] = ["mcap", "db3"];
/// Additional extension of compressed files.
pub(super) const COMPRESSED: &str = "zstd";

/// The files of a bag.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Files {
    pub paths: Vec<PathBuf>,
    /// Remarks about anything unusual, one sentence each.
    pub remarks: Vec<String>,
}

impl Files {
    /// Finds the files of the bag in a folder: those that its metadata names, else those with a matching extension.
    pub fn find(folder: &Path) -> io::Result<Self> {
        let listed = text_file::read(&folder.join(METADATA)).ok().and_then(|text| named(&text));
        let mut there: Vec<PathBuf> = fs::read_dir(folder)?.filter_map(|entry| Some(entry.ok()?.path())).collect();
        there.retain(|path| is_of_bag(path));
        there.sort();
        let shown = folder.display();
        let Some(names) = listed else {
            let remark = || {
                let all = if there.len() == 1 {
                    "its file is".to_owned()
                } else {
                    format!("all its {} files are", there.len())
                };
                format!("`{shown}` has no {METADATA} that can be read, as where the recorder was ended: {all} read")
            };
            let remarks = (!there.is_empty()).then(remark).into_iter().collect();
            return Ok(Self { paths: there, remarks });
        };
        let mut files = Self::default();
        for name in names {
            match at(folder, &name, &there) {
                Some(path) => files.paths.push(path),
                None => files.remarks.push(format!(
                    "`{shown}` has no file `{name}`, which its {METADATA} names: its messages are missing"
                )),
            }
        }
        Ok(files)
    }
}

/// Returns the file with a name; it may have been compressed or decompressed since, or be beside the metadata under its base name. Nothing outside the
/// folder is a file of the bag.
fn at(folder: &Path, name: &str, there: &[PathBuf]) -> Option<PathBuf> {
    let path = folder.join(name);
    let is_inside = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
    if is_inside && path.is_file() {
        return Some(path);
    }
    let last = Path::new(name).file_name()?.to_str()?;
    let unpacked = last.strip_suffix(COMPRESSED).and_then(|name| name.strip_suffix('.'));
    let names = [last.to_owned(), format!("{last}.{COMPRESSED}"), unpacked.unwrap_or(last).to_owned()];
    names.into_iter().map(|name| folder.join(name)).find(|path| there.contains(path))
}

fn is_of_bag(path: &Path) -> bool {
    let ending = |path: &Path| path.extension().and_then(OsStr::to_str).map(str::to_owned);
    let inner = if ending(path).as_deref() == Some(COMPRESSED) { path.with_extension("") } else { path.to_owned() };
    path.is_file() && ending(&inner).is_some_and(|ending| ENDINGS.contains(&ending.as_str()))
}

/// Returns the files that the metadata names.
fn named(text: &str) -> Option<Vec<String>> {
    if is_deep(text) {
        return None;
    }
    let documents = Yaml::load_from_str(text).ok()?;
    let bag = documents.first()?.as_mapping_get("rosbag2_bagfile_information")?;
    let paths = bag.as_mapping_get("relative_file_paths")?.as_sequence()?;
    Some(paths.iter().filter_map(|path| path.as_str().map(ToOwned::to_owned)).collect())
}

/// Deepest nesting within a line, and of brackets; the recorder's has some five levels. The parser calls itself for each.
const DEEPEST: usize = 64;

/// Whether a text nests so deeply that the parser would run out of stack.
fn is_deep(text: &str) -> bool {
    let marks = |line: &str| line.split_whitespace().take_while(|word| ["-", "?"].contains(word)).count();
    let mut depth = 0_usize;
    let mut deepest = 0;
    for character in text.chars() {
        match character {
            '[' | '{' => depth += 1,
            ']' | '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        deepest = deepest.max(depth);
    }
    deepest > DEEPEST || text.lines().any(|line| marks(line) > DEEPEST)
}
