//! `include/fric.h` is what cbindgen makes of the sources.

use std::path::Path;

/// `FRIC_WRITE_HEADER=1 cargo test -p fric-capi header` writes it anew.
#[test]
#[cfg_attr(miri, ignore = "reads files")]
fn the_header_in_the_tree_is_that_of_the_sources() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let header = package.join("include/fric.h");
    let mut made = Vec::new();
    cbindgen::generate(package).unwrap().write(&mut made);
    let made = String::from_utf8(made).unwrap();
    if std::env::var_os("FRIC_WRITE_HEADER").is_some() {
        std::fs::write(&header, &made).unwrap();
    }
    let kept = std::fs::read_to_string(&header).unwrap();
    assert!(made == kept, "include/fric.h is not what the sources give; FRIC_WRITE_HEADER=1 writes it anew");
}
