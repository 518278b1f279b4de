//! The notation of message paths.

use fric_log::path::{Condition, FieldPath, Literal, MessagePath, PathError, Selection, Step};

fn member(name: &str) -> Step {
    Step::Member(name.to_owned())
}

fn slice(first: Option<i64>, last: Option<i64>) -> Step {
    Step::Elements(Selection::Slice { first, last })
}

fn filter(members: &[&str], equal: bool, value: Literal) -> Step {
    let member = members.iter().map(|&name| name.to_owned()).collect();
    Step::Where(Condition { member, equal, value })
}

fn text(text: &str) -> Literal {
    Literal::Text(text.to_owned())
}

fn error(path: &str) -> PathError {
    path.parse::<MessagePath>().unwrap_err()
}

#[test]
fn reads_what_it_writes_and_nothing_else() {
    let one = |index| Step::Elements(Selection::One(index));
    let table: Vec<(&str, &str, Vec<Step>)> = vec![
        ("/cable_states", "/cable_states", vec![]),
        ("cable-states/~x", "cable-states/~x", vec![]),
        ("/a.b", "/a", vec![member("b")]),
        ("/joints.effort[:]", "/joints", vec![member("effort"), slice(None, None)]),
        ("/force.data[2]", "/force", vec![member("data"), one(2)]),
        ("/force.data[-1]", "/force", vec![member("data"), one(-1)]),
        ("/force.data[1:4]", "/force", vec![member("data"), slice(Some(1), Some(4))]),
        ("/force.data[-2:]", "/force", vec![member("data"), slice(Some(-2), None)]),
        ("/force.data[:3]", "/force", vec![member("data"), slice(None, Some(3))]),
        ("/platform.pose.position", "/platform", vec![member("pose"), member("position")]),
        ("/a.b[0][1]", "/a", vec![member("b"), one(0), one(1)]),
        ("/a.\"b c\".d", "/a", vec![member("b c"), member("d")]),
        ("\"/weird.topic\".field", "/weird.topic", vec![member("field")]),
        ("\"a\\\"b\\\\\"", "a\"b\\", vec![]),
        ("/a{id==3}.b", "/a", vec![filter(&["id"], true, Literal::Integer(3)), member("b")]),
        (
            "/tf.transforms[:]{child_frame_id==\"platform\"}.transform",
            "/tf",
            vec![
                member("transforms"),
                slice(None, None),
                filter(&["child_frame_id"], true, text("platform")),
                member("transform"),
            ],
        ),
        (
            "/a.b[:]{h.id!=-4}{on==1}.c",
            "/a",
            vec![
                member("b"),
                slice(None, None),
                filter(&["h", "id"], false, Literal::Integer(-4)),
                filter(&["on"], true, Literal::Integer(1)),
                member("c"),
            ],
        ),
    ];
    for (written, topic, steps) in table {
        let path: MessagePath = written.parse().unwrap();
        assert_eq!(path.topic, topic, "{written}");
        assert_eq!(path.field.steps(), steps, "{written}");
        assert_eq!(path.to_string(), written);
    }
}

#[test]
fn takes_single_quotes_spaces_and_truth_values_in_filters() {
    for (written, value) in [
        ("/a{x=='it''}", None),
        ("/a{x=='it'}", Some(text("it"))),
        ("/a{ x == \"a\\\"b\" }", Some(text("a\"b"))),
        ("/a{x==true}", Some(Literal::Integer(1))),
        ("/a{x == false}", Some(Literal::Integer(0))),
    ] {
        let path = written.parse::<MessagePath>().ok();
        let expected = value.map(|value| vec![filter(&["x"], true, value)]);
        assert_eq!(path.map(|path| path.field.steps().to_vec()), expected, "{written}");
    }
}

#[test]
fn says_where_a_path_goes_wrong_and_what_belongs_there() {
    for (path, position, expected, found) in [
        ("", 1, "a topic", "the end"),
        (".a", 1, "a topic", "`.`"),
        ("\"\".a", 3, "a topic", "`.`"),
        ("/a b", 3, "`.field`", "` `"),
        ("/a[0]", 3, "`.field`", "`[`"),
        ("/a.", 4, "a field name", "the end"),
        ("/a..b", 4, "a field name", "`.`"),
        ("/a.b]", 5, "`.field`", "`]`"),
        ("/a.b[", 6, "an index", "the end"),
        ("/a.b[]", 6, "an index", "`]`"),
        ("/a.b[x]", 6, "an index", "`x`"),
        ("/a.b[-]", 6, "an index", "`-`"),
        ("/a.b[99999999999999999999]", 6, "an index", "`9`"),
        ("/a.b[1", 7, "`]`", "the end"),
        ("/a.b[1:2:3]", 9, "`]`", "`:`"),
        ("/a.b{", 6, "a field name", "the end"),
        ("/a.b{c}", 7, "`==`", "`}`"),
        ("/a.b{c=1}", 7, "`==`", "`=`"),
        ("/a.b{c>1}", 7, "`==`", "`>`"),
        ("/a.b{c==}", 9, "a text", "`}`"),
        ("/a.b{c==$id}", 9, "a text", "`$`"),
        ("/a.b{c==\"d}", 12, "the closing quote", "the end"),
        ("/a.b{c==1", 10, "`}`", "the end"),
        ("/ä.b[ü]", 6, "an index", "`ü`"),
        ("/a.@abs", 4, "a field name", "`@`"),
    ] {
        let error = error(path);
        assert_eq!(error.position, position, "{error}");
        assert!(error.expected.starts_with(expected), "{error}");
        assert_eq!(error.found, found, "{error}");
    }
    assert_eq!(
        error("/a.b[").to_string(),
        "message path `/a.b[`, character 6: expected an index or a slice such as `[2]`, `[1:4]` or `[:]`, found the end"
    );
}

#[test]
fn field_paths_stand_alone_and_join() {
    let pose: FieldPath = "pose".parse().unwrap();
    let x: FieldPath = "position.x".parse().unwrap();
    assert_eq!(pose.clone().join(&x).to_string(), "pose.position.x");
    assert_eq!(pose.member("a b").to_string(), "pose.\"a b\"");
    assert!("".parse::<FieldPath>().unwrap().is_empty());
    assert_eq!(".a".parse::<FieldPath>().unwrap(), "a".parse().unwrap());
    assert!("a.".parse::<FieldPath>().is_err());
}

#[test]
fn selections_are_inclusive_and_count_from_either_end() {
    let slice = |first, last| Selection::Slice { first, last };
    for (selection, count, expected) in [
        (Selection::ALL, 3, 0..3),
        (Selection::ALL, 0, 0..0),
        (Selection::One(0), 3, 0..1),
        (Selection::One(-3), 3, 0..1),
        (Selection::One(-4), 3, 0..0),
        (Selection::One(3), 3, 0..0),
        (Selection::One(i64::MIN), 3, 0..0),
        (Selection::One(i64::MAX), 3, 0..0),
        (slice(Some(1), Some(1)), 3, 1..2),
        (slice(Some(1), Some(2)), 3, 1..3),
        (slice(Some(2), Some(1)), 3, 0..0),
        (slice(Some(-2), None), 3, 1..3),
        (slice(Some(-9), Some(-2)), 3, 0..2),
        (slice(None, Some(-9)), 3, 0..0),
        (slice(Some(5), None), 3, 0..0),
        (slice(Some(0), Some(i64::MAX)), 3, 0..3),
    ] {
        assert_eq!(selection.range(count), expected, "{selection} of {count}");
    }
}
