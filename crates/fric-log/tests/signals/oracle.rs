//! The rows by definition: everything in memory, nothing streamed.

/// A message of a topic: stamp and values.
pub type Measured = (i64, Vec<f64>);

/// What is left of a topic without clock steps, with the number of duplicates, of late messages and of gaps.
pub struct Topic {
    kept: Vec<Measured>,
    gaps: Vec<bool>,
    pub duplicate_count: u64,
    pub late_count: u64,
}

impl Topic {
    /// Messages in the order of the log. Those behind the time are left out.
    pub fn new(messages: &[Measured]) -> Self {
        let mut topic = Self { kept: Vec::new(), gaps: Vec::new(), duplicate_count: 0, late_count: 0 };
        for message in messages {
            match topic.kept.last() {
                Some(last) if last.0 == message.0 => topic.duplicate_count += 1,
                Some(last) if last.0 > message.0 => topic.late_count += 1,
                _ => topic.kept.push(message.clone()),
            }
        }
        let intervals: Vec<i64> = topic.kept.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        topic.gaps = (0..intervals.len()).map(|place| is_gap(&intervals, place)).collect();
        topic
    }

    pub fn kept(&self) -> &[Measured] {
        &self.kept
    }

    pub fn gap_count(&self) -> u64 {
        self.gaps.iter().map(|gap| u64::from(*gap)).sum()
    }

    /// The messages before and after a time that no gap lies between, and the share of the way.
    pub fn around(&self, stamp: i64) -> Option<(&[f64], &[f64], f64)> {
        if let Some(exact) = self.kept.iter().find(|message| message.0 == stamp) {
            return Some((&exact.1, &exact.1, 0.0));
        }
        let after = self.kept.iter().position(|message| message.0 > stamp)?;
        let before = after.checked_sub(1)?;
        if self.gaps[before] {
            return None;
        }
        let (before, after) = (&self.kept[before], &self.kept[after]);
        #[expect(clippy::cast_precision_loss, reason = "intervals")]
        let share = (stamp - before.0) as f64 / (after.0 - before.0) as f64;
        Some((&before.1, &after.1, share))
    }

    pub fn at(&self, stamp: i64, count: usize) -> Vec<f64> {
        match self.around(stamp) {
            None => vec![f64::NAN; count],
            Some((before, _, 0.0)) => before.to_vec(),
            Some((before, after, share)) => {
                before.iter().zip(after).map(|(before, after)| (1.0 - share) * before + share * after).collect()
            }
        }
    }

    /// Spherical interpolation, which the normalised linear one approximates.
    pub fn pose_at(&self, stamp: i64) -> Option<Vec<f64>> {
        let (before, after, share) = self.around(stamp)?;
        let position = before.iter().zip(after).take(3).map(|(before, after)| (1.0 - share) * before + share * after);
        let dot: f64 = before[3..].iter().zip(&after[3..]).map(|(before, after)| before * after).sum();
        let angle = dot.abs().min(1.0).acos();
        let (mut left, mut right) = (1.0 - share, share * dot.signum());
        if angle > 1e-6 {
            left = ((1.0 - share) * angle).sin() / angle.sin();
            right = (share * angle).sin() / angle.sin() * dot.signum();
        }
        let turn = before[3..].iter().zip(&after[3..]).map(|(before, after)| left * before + right * after);
        Some(position.chain(turn).collect())
    }
}

/// Ten times the longest usual interval: of the first eight for these, else of the last 32 before the last eighth one.
fn is_gap(intervals: &[i64], place: usize) -> bool {
    let end = if place < 8 { intervals.len().min(8) } else { place / 8 * 8 };
    let mut window = intervals[end.saturating_sub(32)..end].to_vec();
    window.sort_unstable();
    let left_out = if window.len() == 1 { 0 } else { (window.len() / 8).max(1) };
    intervals[place] > 10 * window[window.len() - 1 - left_out]
}
