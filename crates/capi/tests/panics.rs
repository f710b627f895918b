//! Promise: a panic inside a call becomes a status, and the object is used safely afterwards.

use std::ffi::CStr;

use lin_canny_c::lc_status::*;
use lin_canny_c::*;

fn pair() -> (lc_geometry, lc_pair) {
    let (mut geometry, mut pair) = (lc_geometry { id: 0 }, lc_pair { id: 0 });
    // SAFETY: an array of three numbers and a place for a handle.
    let status = unsafe { lc_shape_new(LC_BOX, [0.5; 3].as_ptr(), 3, &mut geometry) };
    assert_eq!(status, LC_OK);
    // SAFETY: a place for a handle.
    assert_eq!(unsafe { lc_pair_new(geometry, geometry, &mut pair) }, LC_OK);
    (geometry, pair)
}

fn ask(pair: lc_pair, x: f64) -> lc_answer {
    let pose = |x| lc_pose {
        translation: [x, 0.1, 0.2],
        rotation: [0.0, 0.0, 0.0, 1.0],
    };
    let mut answer = std::mem::MaybeUninit::<lc_answer>::uninit();
    let place = answer.as_mut_ptr();
    // SAFETY: two poses and a place for an answer.
    let status = unsafe { lc_pair_ask(pair, &pose(0.0), &pose(x), 7, place, size_of::<lc_answer>()) };
    assert_eq!(status, LC_OK);
    // SAFETY: `LC_OK` says that the answer is written.
    unsafe { answer.assume_init() }
}

#[test]
fn a_panic_is_a_status_with_its_message_and_the_pair_goes_on() {
    let (geometry, pair) = pair();
    let before = ask(pair, 1.7);
    for _ in 0..3 {
        assert_eq!(lc_test_panic(pair), LC_PANIC);
        // SAFETY: a text of the library.
        let message = unsafe { CStr::from_ptr(lc_last_error()) }.to_str().unwrap();
        assert!(
            message.starts_with("a provoked panic at ") && message.contains("pair.rs"),
            "{message}"
        );
        assert_eq!(ask(pair, 1.7), before);
    }
    assert_eq!(lc_pair_free(pair), LC_OK);
    assert_eq!(lc_test_panic(pair), LC_HANDLE);
    assert_eq!(lc_geometry_free(geometry), LC_OK);
}

#[test]
fn a_panic_of_one_thread_leaves_the_others_alone() {
    let pairs: Vec<_> = (0..4).map(|_| pair()).collect();
    std::thread::scope(|scope| {
        for (k, (_, pair)) in pairs.iter().enumerate() {
            scope.spawn(move || {
                for round in 0..200 {
                    if k == 0 {
                        assert_eq!(lc_test_panic(*pair), LC_PANIC);
                    }
                    let x = 1.5 + 1e-3 * f64::from(round);
                    assert!((ask(*pair, x).distance - (x - 1.0)).abs() < 1e-13);
                }
            });
        }
    });
    for (geometry, pair) in pairs {
        assert_eq!(lc_pair_free(pair), LC_OK);
        assert_eq!(lc_geometry_free(geometry), LC_OK);
    }
}
