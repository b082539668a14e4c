#![no_main]

libfuzzer_sys::fuzz_target!(init: mavwire_fuzz::in_one_thread(), |data: &[u8]| mavwire_fuzz::compressed(data));
