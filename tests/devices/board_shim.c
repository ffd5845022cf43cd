/* A board with one channel of each kind around the firmware, for tests: it moves as the simulated one does. */
#include "btlang_board.h"

#include <string.h>

enum { COUNT = 8 };
static btlang_channel channels[COUNT];
static btlang_board board;
static uint8_t out[8192];
static size_t out_count;
static uint32_t sampled[COUNT], turned;
static double left, right, position, joint_speed;
static uint16_t range_mm;
static char name[BTLANG_NAME + 2];

static void write_bytes(const uint8_t *bytes, size_t count) {
    if (out_count + count > sizeof out)
        return;
    memcpy(out + out_count, bytes, count);
    out_count += count;
}

static void apply(btlang_channel *channel) { (void)channel; }

static double rounded(double value) { return value < 0 ? value - 0.5 : value + 0.5; }

static void sample(btlang_channel *channel) {
    const btlang_command *command = &channel->command;
    switch (channel->kind) {
    case BTLANG_RANGE:
        btlang_set_range(channel, range_mm);
        break;
    case BTLANG_DRIVE:
        btlang_set_drive(channel, (int32_t)rounded(left * 10), (int32_t)rounded(right * 10), command->drive.left, command->drive.right);
        break;
    case BTLANG_IMU:
        btlang_set_imu(channel, 0, 0, 0, 981, 0);
        break;
    case BTLANG_BATTERY:
        btlang_set_battery(channel, 8000, 12000, -100, 250, 0);
        break;
    case BTLANG_BUTTON:
        btlang_set_button(channel, false);
        break;
    case BTLANG_JOINT:
        btlang_set_joint(channel, (int32_t)rounded(position * 100), (int16_t)rounded(joint_speed * 10), 10, 30, command->joint.loose);
        break;
    default:
        break;
    }
}

bool shim_reset(const char *called) {
    static const uint16_t intervals[COUNT] = {50, 20, 20, 500, 20, 20, 0, 0};
    strncpy(name, called, sizeof name - 1);
    memset(channels, 0, sizeof channels);
    memset(sampled, 0, sizeof sampled);
    left = right = position = 0;
    turned = 0;
    range_mm = 1000;
    out_count = 0;
    board.name = name;
    board.channels = channels;
    board.channel_count = COUNT;
    board.write = write_bytes;
    board.apply = apply;
    for (uint8_t at = 0; at < COUNT; at++) {
        channels[at].number = channels[at].kind = (uint8_t)(at + 1);
        channels[at].interval_ms = intervals[at];
    }
    bool fits = btlang_begin(&board);
    for (uint8_t at = 0; at < COUNT; at++) {
        sample(&channels[at]);
        channels[at].count = 0;
    }
    return fits;
}

/* Returns the bytes that it answers. */
size_t shim_receive(const uint8_t *bytes, size_t count, uint32_t now_ms, uint8_t *answer) {
    out_count = 0;
    for (size_t at = 0; at < count; at++)
        btlang_receive(&board, bytes[at], now_ms);
    memcpy(answer, out, out_count);
    return out_count;
}

/* `board_ms` is what the board believes to be the time. */
void shim_turn(uint32_t now_ms, uint32_t board_ms, uint32_t frozen) {
    double seconds = (now_ms - turned) * 0.001;
    const btlang_command *joint = &channels[BTLANG_JOINT - 1].command;
    btlang_turn(&board, board_ms);
    turned = now_ms;
    left += channels[BTLANG_DRIVE - 1].command.drive.left * seconds;
    right += channels[BTLANG_DRIVE - 1].command.drive.right * seconds;
    joint_speed = 0;
    if (joint->joint.goes) {
        double most = (joint->joint.speed == BTLANG_ANY_SPEED ? 90 : joint->joint.speed * 0.1) * seconds;
        double way = joint->joint.position * 0.01 - position;
        way = way > most ? most : way < -most ? -most : way;
        position += way;
        joint_speed = seconds > 0 ? way / seconds : 0;
    }
    for (uint8_t at = 0; at < COUNT; at++) {
        if (now_ms - sampled[at] < channels[at].interval_ms)
            continue;
        sampled[at] = now_ms;
        if (!(frozen & (1u << (at + 1))))
            sample(&channels[at]);
    }
}

void shim_set_range(uint16_t mm) { range_mm = mm; }

int shim_left(void) { return channels[BTLANG_DRIVE - 1].command.drive.left; }

int shim_right(void) { return channels[BTLANG_DRIVE - 1].command.drive.right; }

void shim_text(char *text) { memcpy(text, channels[BTLANG_DISPLAY - 1].command.text, BTLANG_TEXT + 1); }
