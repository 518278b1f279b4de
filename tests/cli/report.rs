//! `replay --report`: one page that needs nothing else.

use serde_json::Value;

use super::logs::{Storage, rewrite, without};
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
    let (page, _) = without_scripts(&page);
    for markup in ["<b>", "<i>", "alert(1)<", "&\""] {
        assert!(!page.contains(markup), "{markup}");
    }
    assert!(page.contains("&lt;b&gt;&amp;&quot;1") && page.contains("&lt;i&gt;&amp;.mcap"), "the names are there");
}

/// The text of the first element of a name.
fn element<'a>(page: &'a str, name: &str) -> &'a str {
    let (_, after) = page.split_once(&format!("<{name}")).unwrap();
    let (_, text) = after.split_once('>').unwrap();
    text.split_once('<').unwrap().0
}

#[test]
fn what_gets_worse_is_said_first() {
    let place = Place::with_log();
    place.write("rough.toml", example_robot().replacen("mu = 0.0", "offset_n = 4.0, mu = 0.0", 2));
    let run = place
        .run(&["replay", "log.mcap", "--model", "rough.toml", "--report", "r.html", "--json", "j.json"])
        .succeeds();
    let page = String::from_utf8(place.read("r.html")).unwrap();
    let result = place.json("j.json");
    let rms = |of: &serde_json::Value, when: &str, key: &str| of[when][key].as_f64().unwrap();
    let mut expected: Vec<String> = result["cables"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|cable| rms(cable, "after", "rms_n") > rms(cable, "before", "rms_n"))
        .map(|cable| {
            let [before, after] = ["before", "after"].map(|when| rms(cable, when, "rms_n"));
            format!("{} (rms {before:.4} N before, {after:.4} N after)", cable["name"].as_str().unwrap())
        })
        .collect();
    assert_eq!(expected.len(), 2, "{result}");
    for (name, key, unit) in [("force", "force_rms_n", "N"), ("torque", "torque_rms_nm", "Nm")] {
        let [before, after] = ["before", "after"].map(|when| rms(&result["wrench"], when, key));
        assert!(after > before, "{result}");
        expected.push(format!("the {name} on the platform (rms {before:.4} {unit} before, {after:.4} {unit} after)"));
    }
    let verdict = element(&page, "h1");
    assert!(verdict.starts_with(&format!("Compensation makes {}", expected[0])), "{verdict}");
    for worse in &expected {
        assert!(verdict.contains(worse), "{worse}: {verdict}");
    }
    let told = run.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(told.starts_with(verdict), "{told}");
}

#[test]
fn a_page_of_a_log_says_what_it_allows() {
    let place = Place::with_log();
    let info = ["info", "log.mcap", "--report", "r.html", "--json", "j.json"];
    place.run(&info).succeeds();
    let page = String::from_utf8(place.read("r.html")).unwrap();
    assert_self_contained(&page);
    assert_eq!(page.matches("<svg").count(), 3);
    for step in place.json("j.json")["steps"].as_array().unwrap() {
        assert!(page.contains(step["step"].as_str().unwrap()));
    }
    place.run_in_vain(&["info", "log.mcap", "--report", "x", "--json", "x"]).fails(2, &["two outputs"]);
    place.write("bare.mcap", rewrite(short_log(), Storage::Zstd, None, |_, _| true));
    place.run(&["info", "bare.mcap", "--report", "bare.html"]).succeeds();
    let page = String::from_utf8(place.read("bare.html")).unwrap();
    assert!(element(&page, "h1").contains("not known without a robot file"), "{}", element(&page, "h1"));
}

#[test]
fn results_name_their_inputs_and_no_machine() {
    let place = Place::with_log();
    let log = place.path("log.mcap");
    place.run(&["replay", log.to_str().unwrap(), "--report", "r.html", "--json", "j.json"]).succeeds();
    let result: Value = serde_json::from_slice(&place.read("j.json")).unwrap();
    let made = &result["provenance"];
    assert_eq!(made["command"], "fric-cli replay log.mcap --report r.html --json j.json");
    assert_eq!((&made["program"], &made["version"]), (&"fric".into(), &env!("CARGO_PKG_VERSION").into()));
    let folder = log.parent().unwrap().to_str().unwrap();
    for name in ["r.html", "j.json"] {
        let text = String::from_utf8(place.read(name)).unwrap();
        assert!(!text.contains(folder) && text.contains("log.mcap"), "{name}");
    }
    let (input, page) = (&made["inputs"][0], String::from_utf8(place.read("r.html")).unwrap());
    let hash = input["sha256"].as_str().unwrap();
    assert_eq!((&input["role"], &input["name"], hash.len()), (&"log".into(), &"log.mcap".into(), 64));
    assert!(page.contains(hash) && page.contains(made["made"].as_str().unwrap().split_once('T').unwrap().0));
}
