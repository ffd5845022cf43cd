// A board with an ultrasonic sensor, two motors with encoders, a battery and a bumper, for Arduino and ESP32.
//
// Open this folder in the Arduino IDE, or copy it. Change the name, the pins and the constants of your robot, then name
// the board in the robot file: port = "board base". The page docs/serial-board.md of btlang has all about it.

#include "btlang_board.h"

const uint8_t TRIGGER = 4, ECHO = 5, BUMPER = 6, BATTERY = A0;
const uint8_t LEFT_PWM = 9, LEFT_BACK = 8, RIGHT_PWM = 10, RIGHT_BACK = 11;
const uint8_t LEFT_A = 2, LEFT_B = 12, RIGHT_A = 3, RIGHT_B = 13; // A of each on pins with interrupts
const float TENTHS_MM_PER_TICK = 5.2;
const float PWM_PER_MM_S = 0.35;
const float MILLIVOLTS_PER_STEP = 16.1;
const float EMPTY_MV = 10500, FULL_MV = 12600;
const uint32_t DRIVE_MS = 20, RANGE_MS = 60, BATTERY_MS = 500;

volatile int32_t leftTicks = 0, rightTicks = 0;

btlang_channel channels[4];
btlang_channel &range = channels[0], &drive = channels[1], &battery = channels[2], &bumper = channels[3];
btlang_board board;

void leftTick() { leftTicks += digitalRead(LEFT_B) ? 1 : -1; }
void rightTick() { rightTicks += digitalRead(RIGHT_B) ? 1 : -1; }

void turnWheel(uint8_t pwm, uint8_t back, int16_t mmPerSecond) {
  digitalWrite(back, mmPerSecond < 0);
  analogWrite(pwm, constrain((int)(abs((long)mmPerSecond) * PWM_PER_MM_S), 0, 255));
}

extern "C" void sendBytes(const uint8_t *bytes, size_t count) { Serial.write(bytes, count); }

extern "C" void applyCommand(btlang_channel *channel) {
  if (channel == &drive) {
    turnWheel(LEFT_PWM, LEFT_BACK, channel->command.drive.left);
    turnWheel(RIGHT_PWM, RIGHT_BACK, channel->command.drive.right);
  }
}

void sampleDrive() {
  static int32_t lastLeft = 0, lastRight = 0;
  noInterrupts();
  int32_t left = leftTicks, right = rightTicks;
  interrupts();
  float perSecond = TENTHS_MM_PER_TICK * 0.1 * 1000 / DRIVE_MS;
  btlang_set_drive(&drive, left * TENTHS_MM_PER_TICK, right * TENTHS_MM_PER_TICK, (left - lastLeft) * perSecond,
                   (right - lastRight) * perSecond);
  lastLeft = left;
  lastRight = right;
  btlang_set_button(&bumper, !digitalRead(BUMPER));
}

void sampleRange() {
  digitalWrite(TRIGGER, HIGH);
  delayMicroseconds(10);
  digitalWrite(TRIGGER, LOW);
  uint32_t micros = pulseIn(ECHO, HIGH, 12000); // 2 m, so that a turn never takes longer than 12 ms
  btlang_set_range(&range, micros ? (uint16_t)(micros * 0.1715) : BTLANG_NOTHING_IN_RANGE);
}

void sampleBattery() {
  float millivolts = analogRead(BATTERY) * MILLIVOLTS_PER_STEP;
  float share = constrain((millivolts - EMPTY_MV) / (FULL_MV - EMPTY_MV), 0.0f, 1.0f);
  btlang_set_battery(&battery, share * 10000, millivolts, BTLANG_UNKNOWN, BTLANG_UNKNOWN, 2);
}

bool due(uint32_t &last, uint32_t interval) {
  if (millis() - last < interval) return false;
  last += interval;
  return true;
}

void setup() {
  Serial.begin(115200);
  const uint8_t outputs[] = {TRIGGER, LEFT_PWM, LEFT_BACK, RIGHT_PWM, RIGHT_BACK};
  for (uint8_t pin : outputs) pinMode(pin, OUTPUT);
  const uint8_t inputs[] = {ECHO, LEFT_B, RIGHT_B};
  for (uint8_t pin : inputs) pinMode(pin, INPUT);
  const uint8_t pulled[] = {BUMPER, LEFT_A, RIGHT_A};
  for (uint8_t pin : pulled) pinMode(pin, INPUT_PULLUP);
  attachInterrupt(digitalPinToInterrupt(LEFT_A), leftTick, RISING);
  attachInterrupt(digitalPinToInterrupt(RIGHT_A), rightTick, RISING);

  range.number = 1, range.kind = BTLANG_RANGE, range.interval_ms = RANGE_MS;
  drive.number = 2, drive.kind = BTLANG_DRIVE, drive.interval_ms = DRIVE_MS;
  battery.number = 3, battery.kind = BTLANG_BATTERY, battery.interval_ms = BATTERY_MS;
  bumper.number = 4, bumper.kind = BTLANG_BUTTON, bumper.interval_ms = DRIVE_MS;
  board.name = "base";
  board.channels = channels;
  board.channel_count = 4;
  board.write = sendBytes;
  board.apply = applyCommand;
  while (!btlang_begin(&board)) {} // a mistake in the lines above: it never answers
}

void loop() {
  static uint32_t driven = 0, ranged = 0, charged = 0;
  while (Serial.available()) btlang_receive(&board, Serial.read(), millis());
  btlang_turn(&board, millis());
  if (due(driven, DRIVE_MS)) sampleDrive();
  if (due(ranged, RANGE_MS)) sampleRange();
  if (due(charged, BATTERY_MS)) sampleBattery();
}
