//! `man`: the manual pages, generated from the texts of `--help`.

use std::fs;
use std::path::Path;

use clap::{Command, CommandFactory as _};
use clap_mangen::Man;
use fric_log::output::{OutputError, OutputFile};

use crate::arguments::{Arguments, ManArguments};
use crate::failure::{Failure, Outcome};
use crate::output::{self, Written};

/// Runs the command.
pub fn run(arguments: &ManArguments) -> Outcome {
    let ManArguments { directory, force } = arguments;
    if directory.exists() && !directory.is_dir() {
        let failure = Failure::new(format!("{} is no directory", directory.display()));
        return Err(failure.advise("Name a directory; it is made if it is missing."));
    }
    let refused = |source| OutputError::File { path: directory.clone(), source };
    fs::create_dir_all(directory).map_err(refused)?;
    let mut program = Arguments::command();
    program.build();
    let mut pages = Vec::new();
    write_pages(&program, directory, *force, &mut pages)?;
    output::show_with("", pages, "")
}

/// Writes the page of a command and those of its subcommands.
fn write_pages(command: &Command, directory: &Path, force: bool, pages: &mut Vec<Written>) -> Outcome {
    let man = Man::new(command.clone());
    let mut text = Vec::new();
    let path = directory.join(man.get_filename());
    man.render(&mut text).map_err(|source| OutputError::File { path: path.clone(), source })?;
    let file = OutputFile::create(&path, &[] as &[&Path], force)?;
    let told = format!("the manual page of `{}`", command.get_bin_name().unwrap_or(command.get_name()));
    pages.push(Written::new(file.complete_with(&String::from_utf8_lossy(&text))?, told));
    for below in command.get_subcommands().filter(|below| below.get_name() != "help" && !below.is_hide_set()) {
        write_pages(below, directory, force, pages)?;
    }
    Ok(())
}
