
use super::robots::*;
#[test]
fn tmp_probe() {
    let mut sim = simulate(&eight_cables(), &noiseless());
    let t0 = std::time::Instant::now();
    let mut k = 0u32;
    let mut all = Vec::new();
    while let Some(c) = sim.next_cycle() {
        let max = c.reference_force_n.iter().copied().fold(0.0, f64::max);
        if k % 1000 == 0 { println!("{:.1} {:.2} {:?} {:?}", f64::from(k)*1e-3, max, c.pose.unwrap().position_m.as_slice(), c.reference_force_n.iter().map(|f| (f*10.0).round()/10.0).collect::<Vec<_>>()); }
        all.extend(c.reference_force_n.iter().copied());
        k += 1;
    }
    println!("{k} cycles {:?}", t0.elapsed());
    all.sort_by(f64::total_cmp);
    for q in [0.001,0.01,0.1,0.5,0.9,0.99,0.999] { println!("{q} {}", all[(all.len() as f64*q) as usize]); }
}
