/* What the sketch uses of Arduino, so that this computer's compiler can read it. */
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

enum { LOW, HIGH, INPUT, OUTPUT, INPUT_PULLUP, RISING, A0 };
struct SerialPort {
    void begin(long) {}
    int available() { return 0; }
    int read() { return -1; }
    size_t write(const uint8_t *, size_t count) { return count; }
};
extern SerialPort Serial;
void pinMode(uint8_t, uint8_t);
void digitalWrite(uint8_t, uint8_t);
int digitalRead(uint8_t);
void analogWrite(uint8_t, int);
int analogRead(uint8_t);
void delayMicroseconds(unsigned);
uint32_t pulseIn(uint8_t, uint8_t, uint32_t);
uint32_t millis();
void noInterrupts();
void interrupts();
int digitalPinToInterrupt(uint8_t);
void attachInterrupt(int, void (*)(), int);
template <class T> T constrain(T value, T low, T high) { return value < low ? low : value > high ? high : value; }
