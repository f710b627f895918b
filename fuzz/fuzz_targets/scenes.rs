//! Arbitrary bytes are a sequence of calls of a scene: the entry of the test `scene`.
#![no_main]

use lin_canny::scene::Scene;
use truth::driven::scenes;

fn read_back(scene: &Scene) -> Scene {
    let text = serde_json::to_string(scene).expect("a scene is written");
    serde_json::from_str(&text).expect("what was written is read")
}

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    scenes::drive(data, read_back);
});
