#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| mavwire_fuzz::rewrite(data));
