//! The touch scenario on the port.

use sutura_hil::{port, remote};

#[test]
fn the_touch_scenario_passes_on_the_port() {
    let Some(port) = port("the touch scenario on a port").unwrap() else {
        return;
    };
    let timing = remote::touch(port).unwrap();
    println!("{timing}");
    assert_eq!(timing.ticks, remote::TICKS);
}
