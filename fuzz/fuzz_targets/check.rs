#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    hypedc_fuzz::check(bytes);
});
