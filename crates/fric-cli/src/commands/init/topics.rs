//! Guesses the signals of topics from the message types and the topic names.

use std::collections::BTreeMap;

use fric_core::robot::file::{LogTable, ReferenceTable};
use fric_log::log::Log;
use fric_log::path::FieldPath;
use fric_log::recording::Message;
use fric_log::schema::{MessageType, Wanted};

use super::draft::Draft;
use crate::failure::Outcome;

/// Maximum number of messages that are searched for topics.
const MOST_MESSAGES: usize = 50_000;

/// The content of a topic's messages.
#[derive(Debug, Default)]
struct Topic {
    type_name: String,
    joints: Option<Joints>,
}

/// The content of messages like `JointState`.
#[derive(Debug, Default)]
struct Joints {
    names: Vec<String>,
    has_position: bool,
    has_effort: bool,
}

/// Guesses the signals of a log of messages.
pub fn guess(log: &mut Log, draft: &mut Draft) -> Outcome {
    let mut topics: BTreeMap<String, Topic> = BTreeMap::new();
    for _ in 0..MOST_MESSAGES {
        let Some(message) = log.next_message()? else { break };
        if !topics.contains_key(&message.channel.topic) {
            topics.insert(message.channel.topic.clone(), look_at(&message));
        }
    }
    let LogTable { cable, reference, pose, wrench, .. } = LogTable::default();
    let reference = match reference {
        ReferenceTable::Signal(topic) => topic,
        ReferenceTable::Known(_) => String::new(),
    };
    let joints = |wanted: fn(&Joints) -> bool| -> Vec<&String> {
        let is_wanted = |topic: &Topic| topic.joints.as_ref().is_some_and(wanted);
        topics.iter().filter(|(_, topic)| is_wanted(topic)).map(|(name, _)| name).collect()
    };
    let of_type = |endings: &[&str]| -> Vec<&String> {
        let is_wanted = |topic: &Topic| endings.iter().any(|ending| topic.type_name.ends_with(ending));
        topics.iter().filter(|(_, topic)| is_wanted(topic)).map(|(name, _)| name).collect()
    };
    let cables = joints(|it| it.has_effort && it.has_position);
    let found = choose(
        draft,
        "cable",
        &cable,
        &cables,
        &["cable", "winch", "joint"],
        "JointState messages with position and effort",
    );
    let names = found.and_then(|name| topics.get(&name)?.joints.as_ref()).map(|joints| joints.names.clone());
    draft.cables = names.filter(|names| !names.is_empty()).unwrap_or_else(|| {
        draft.notes.push("cables: their names could not be found in the log; one stands for all".to_owned());
        vec!["cable1".to_owned()]
    });
    let references = joints(|it| it.has_effort && !it.has_position);
    choose(draft, "reference", &reference, &references, &["ref", "platform"], "JointState messages with effort alone");
    let poses = of_type(&["/PoseStamped", "/TransformStamped", "/Pose", "/PoseWithCovarianceStamped"]);
    draft.has_pose = choose(draft, "pose", &pose, &poses, &["platform", "pose"], "PoseStamped messages").is_some();
    choose(
        draft,
        "wrench",
        &wrench,
        &of_type(&["/WrenchStamped", "/Wrench"]),
        &["platform", "wrench"],
        "WrenchStamped messages",
    );
    Ok(())
}

/// Chooses the topic of a signal, and adds a note if it cannot.
fn choose(
    draft: &mut Draft,
    key: &'static str,
    standard: &str,
    found: &[&String],
    words: &[&str],
    what: &str,
) -> Option<String> {
    let likeness = |name: &&&String| {
        let word = words.iter().position(|word| name.contains(word)).unwrap_or(words.len());
        (usize::from(name.as_str() != standard), word)
    };
    let Some(best) = found.iter().min_by_key(likeness) else {
        draft
            .notes
            .push(format!("{key}: the log has no topic with {what}; name one, or a path to a field, under [log]"));
        return None;
    };
    let others: Vec<&str> = found.iter().filter(|name| name != &best).map(|name| name.as_str()).collect();
    if !others.is_empty() {
        draft.notes.push(format!("{key}: {best} was taken; {} could be meant too", others.join(", ")));
    }
    if best.as_str() != standard {
        draft.paths.push((key, (*best).clone()));
    }
    Some((*best).clone())
}

fn look_at(message: &Message<'_>) -> Topic {
    let channel = message.channel;
    let Some(schema) = &channel.schema else { return Topic::default() };
    let joints = || -> Option<Joints> {
        let of = MessageType::new(&channel.message_encoding, &schema.name, &schema.encoding, &schema.data).ok()?;
        let field = |name: &str| FieldPath::default().member(name);
        let numbers = ["position", "effort"].map(|name| Wanted::numbers(field(name)));
        let [position, effort] = numbers;
        let mut decoder = of.decoder(&[Wanted::texts(field("name")), position, effort]).ok()?;
        let values = decoder.read(message.data).ok()?;
        Some(Joints {
            names: values.texts(0).iter().map(ToOwned::to_owned).collect(),
            has_position: !values.numbers(1).is_empty(),
            has_effort: !values.numbers(2).is_empty(),
        })
    };
    Topic { type_name: schema.name.clone(), joints: joints() }
}
