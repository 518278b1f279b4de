//! Names of recordings that are written: always MCAP, and so not under the name of another kind of file.

use std::path::Path;

/// Endings of files that a recording is not.
const OTHER_ENDINGS: [&str; 11] = ["csv", "tsv", "txt", "json", "html", "toml", "db3", "bag", "xlsx", "mat", "parquet"];

/// Checks that a recording is not named as another kind of file.
///
/// # Errors
/// Returns what is wrong and what to do, without the name.
pub fn check(path: &Path) -> Result<(), &'static str> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase();
    let is_other = OTHER_ENDINGS.contains(&ending.as_str());
    if is_other { Err("what is written is MCAP; name it `.mcap`") } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recording_is_not_named_as_another_file() {
        for name in ["x.csv", "x.CSV", "x.mcap.json", "x.toml"] {
            assert!(check(Path::new(name)).is_err(), "{name}");
        }
        for name in ["x.mcap", "x", "x.2026-01-01", "csv"] {
            assert!(check(Path::new(name)).is_ok(), "{name}");
        }
    }
}
