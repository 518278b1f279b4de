//! The page of `discover --report`.

use fric_lab::discover::CableDiscovery;
use fric_lab::discover::result::DiscoverResult;
use maud::html;

/// The page.
pub fn page(result: &DiscoverResult, _discoveries: &[CableDiscovery]) -> String {
    super::shell(&result.robot, &html! {})
}
