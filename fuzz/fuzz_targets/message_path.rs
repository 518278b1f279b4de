//! A text as a message path, and what is written of it as the same path.
#![no_main]

use fric_log::path::{FieldPath, MessagePath, Step};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match text.parse::<MessagePath>() {
        Ok(path) => {
            let written = path.to_string();
            assert_eq!(written.parse::<MessagePath>().as_ref(), Ok(&path), "{written}");
            check_selections(&path.field);
        }
        Err(error) => {
            assert!((1..=text.chars().count() + 1).contains(&error.position), "{error}");
        }
    }
    if let Ok(path) = text.parse::<FieldPath>() {
        let written = path.to_string();
        assert_eq!(written.parse::<FieldPath>().as_ref(), Ok(&path), "{written}");
    }
});

/// What is selected lies within the array.
fn check_selections(path: &FieldPath) {
    for step in path.steps() {
        if let Step::Elements(selection) = step {
            for count in [0, 1, 3, usize::MAX] {
                let range = selection.range(count);
                assert!(range.start <= range.end && range.end <= count, "{selection} of {count}: {range:?}");
            }
        }
    }
}
