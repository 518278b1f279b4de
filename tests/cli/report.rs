//! `replay --report`: one page that needs nothing else.

use super::logs::without;
use super::support::{Place, example_robot, short_log};

fn report(place: &Place, arguments: &[&str]) -> String {
    place.run(&[&["replay"], arguments, &["--report", "r.html", "--force"]].concat());
    String::from_utf8(place.read("r.html")).unwrap()
}

/// The page without its own scripts, and these.
pub fn without_scripts(page: &str) -> (String, String) {
    let (mut rest, mut kept, mut scripts) = (page, String::new(), String::new());
    for open in ["<script type=\"application/json\" id=\"fric-plots\">", "<script>", "<script>"] {
        let Some((before, after)) = rest.split_once(open) else { break };
        let (script, after) = after.split_once("</script>").unwrap();
        kept += before;
        scripts += script;
        rest = after;
    }
    (kept + rest, scripts)
}

#[track_caller]
pub fn assert_self_contained(page: &str) {
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    let (page, scripts) = without_scripts(page);
    assert!(!scripts.contains("http:") && !scripts.contains("https:") && !scripts.contains("import("));
    let page = page.replace("href=\"#", "");
    for foreign in [
        "http:",
        "https:",
        "<script",
        "<link",
        "<iframe",
        "<img",
        "<object",
        "@import",
        "url(",
        "src=",
        "href=",
        "javascript:",
        " onload",
    ] {
        assert!(!page.to_lowercase().contains(foreign), "{foreign} in the page");
    }
    assert_eq!(page.matches("<svg").count(), page.matches("</svg>").count());
    assert!(!page.contains("NaN") && !page.contains("inf\""), "a number that is none");
}

#[test]
fn the_page_is_self_contained() {
    let place = Place::with_log();
    let page = report(&place, &["log.mcap", "--json", "j.json"]);
    assert_self_contained(&page);
    // Of each cable the error, the friction over speed and over length; all forces; six components of the wrench.
    assert_eq!(page.matches("<svg").count(), 3 * 8 + 1 + 6);
    let result = place.json("j.json");
    for cable in result["cables"].as_array().unwrap() {
        assert!(page.contains(cable["name"].as_str().unwrap()));
        for when in ["before", "after"] {
            assert!(page.contains(&format!("{:.4}", cable[when]["rms_n"].as_f64().unwrap())));
        }
    }
    assert!(page.contains(&format!("{:.4} Nm", result["wrench"]["after"]["torque_rms_nm"].as_f64().unwrap())));
}

#[test]
fn a_log_without_a_reference_has_a_page_too() {
    let place = Place::empty();
    place.write("log.mcap", without(short_log(), &["/reference_forces", "/platform_wrench"]));
    let page = report(&place, &["log.mcap"]);
    assert_self_contained(&page);
    assert_eq!(page.matches("no reference").count(), 8);
}

#[test]
fn names_are_text_and_no_markup() {
    let place = Place::empty();
    let robot = example_robot().replacen("\"mini-ipanema\"", r#"'<b>&"robot</b>'"#, 1).replacen(
        "\"cable1\"",
        r#"'<b>&"1<script>alert(1)</script>'"#,
        1,
    );
    place.write("robot.toml", robot);
    let simulate = ["simulate", "--model", "robot.toml", "-o", "<i>&.mcap", "--duration", "0.1"];
    place.run(&simulate).succeeds();
    let page = report(&place, &["<i>&.mcap"]);
    assert_self_contained(&page);
    for markup in ["<b>", "<i>", "alert(1)<", "&\""] {
        assert!(!page.contains(markup), "{markup}");
    }
    assert!(page.contains("&lt;b&gt;&amp;&quot;1") && page.contains("&lt;i&gt;&amp;.mcap"), "the names are there");
}
