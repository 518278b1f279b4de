//! The robot of a case as the seed draws it: sizes, mass and friction, and its text as a robot file.

use core::fmt::Write as _;

use rand_chacha::ChaCha8Rng;

use super::super::robots::{CABLE_COUNT, Friction, GUESS, cable_line, friction_line, head};
use crate::random::uniform;
use crate::simulate::hidden::HiddenEffect;

/// Half edges of the frame and of the platform at scale 1, m.
const FRAME_M: [f64; 3] = [0.55, 0.4, 0.5];
const PLATFORM_M: [f64; 3] = [0.06, 0.05, 0.05];

/// A robot with a cable from each corner of a frame.
#[derive(Clone, Debug)]
pub struct Body {
    pub mass_kg: f64,
    /// Where each cable enters its last pulley, and where it holds the platform, m.
    pub points_m: Vec<[[f64; 3]; 2]>,
    pub friction: Vec<Friction>,
    pub effects: Vec<Vec<HiddenEffect>>,
}

impl Body {
    pub fn draw(random: &mut ChaCha8Rng) -> Self {
        let frame_m = FRAME_M.map(|edge_m| edge_m * uniform(random, 0.8, 1.6));
        let platform_m = PLATFORM_M.map(|edge_m| edge_m * uniform(random, 0.8, 1.8));
        let points_m = (0..CABLE_COUNT).map(|cable| {
            let sign = |is_positive| if is_positive { 1.0 } else { -1.0 };
            let [x, y, z] = [sign(matches!(cable % 4, 0 | 3)), sign(cable % 4 < 2), sign(cable < 4)];
            // Cables from above hold the platform's lower corners, and those from below its upper ones.
            let at = |edges_m: [f64; 3], z: f64| [x * edges_m[0], y * edges_m[1], z * edges_m[2]];
            [at(frame_m, z), at(platform_m, -z)]
        });
        let points_m = points_m.collect();
        let mass_kg = uniform(random, 0.4, 1.5);
        let friction = (0..CABLE_COUNT).map(|_| Friction {
            mu: uniform(random, 0.011, 0.025),
            sigma_n_per_m: uniform(random, 600.0, 1250.0),
            viscous_n_s_per_m: uniform(random, 0.08, 0.4),
        });
        Self { mass_kg, points_m, friction: friction.collect(), effects: vec![Vec::new(); CABLE_COUNT] }
    }

    /// The same as a user has it: friction as guessed, nothing of the effects.
    pub fn guessed(&self) -> Self {
        Self { friction: vec![GUESS; CABLE_COUNT], effects: vec![Vec::new(); CABLE_COUNT], ..self.clone() }
    }

    /// The robot file.
    pub fn text(&self) -> String {
        let mut text = head(self.mass_kg);
        let cables = self.points_m.iter().zip(&self.friction).zip(&self.effects).enumerate();
        for (cable, (([base_m, platform_m], friction), effects)) in cables {
            text += &cable_line(cable, *base_m, *platform_m);
            text += &friction_line(friction);
            if !effects.is_empty() {
                let tables: Vec<String> = effects.iter().map(table).collect();
                let _ = writeln!(text, "effects = [{}]", tables.join(", "));
            }
        }
        text
    }
}

fn table(effect: &HiddenEffect) -> String {
    let values = effect.values().iter().map(|(key, value)| format!(", {key} = {value:?}"));
    format!("{{ kind = \"{}\"{} }}", effect.effect().kind(), values.collect::<String>())
}
