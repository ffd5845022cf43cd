/* See btlang_board.h. */
#include "btlang_board.h"

#include <string.h>

enum { ASK_HELLO = 0x01, TELL = 0x02, STOP = 0x03, HELLO = 0x81, ANSWER = 0x82 };
enum { LOOSE = 1, GOES = 2 };
enum { CRC_SIZE = 2, TELL_HEAD = 5, ANSWER_HEAD = 9, HELLO_HEAD = 7 };

static uint16_t crc16(const uint8_t *data, size_t count) {
    uint16_t crc = 0xFFFF;
    while (count--) {
        crc = (uint16_t)(crc ^ (uint16_t)(*data++ << 8));
        for (int bit = 0; bit < 8; bit++)
            crc = (uint16_t)((crc & 0x8000) ? (crc << 1) ^ 0x1021 : crc << 1);
    }
    return crc;
}

static uint8_t *put16(uint8_t *at, uint16_t value) {
    *at++ = (uint8_t)(value & 0xFF);
    *at++ = (uint8_t)(value >> 8);
    return at;
}

static uint8_t *put32(uint8_t *at, uint32_t value) {
    return put16(put16(at, (uint16_t)(value & 0xFFFF)), (uint16_t)(value >> 16));
}

static uint16_t get16(const uint8_t *at) { return (uint16_t)(at[0] | (at[1] << 8)); }

static uint32_t get32(const uint8_t *at) { return get16(at) | ((uint32_t)get16(at + 2) << 16); }

static int reading_size(uint8_t kind) {
    static const int8_t sizes[] = {-1, 2, 12, 14, 9, 1, 9, 0, 0};
    return kind < sizeof sizes ? sizes[kind] : -1;
}

static int command_size(uint8_t kind) {
    static const int8_t sizes[] = {0, 0, 4, 0, 0, 0, 7, 3, BTLANG_TEXT};
    return kind < sizeof sizes ? sizes[kind] : 0;
}

static bool moves(uint8_t kind) { return kind == BTLANG_DRIVE || kind == BTLANG_JOINT; }

/* `message` has room for the CRC after its `count` bytes. */
static void send_frame(btlang_board *board, uint8_t *message, size_t count) {
    uint8_t frame[BTLANG_MOST + 2];
    size_t code = 0, at = 1;
    put16(message + count, crc16(message, count));
    for (size_t byte = 0; byte < count + CRC_SIZE; byte++) {
        if (message[byte]) {
            frame[at++] = message[byte];
        } else {
            frame[code] = (uint8_t)(at - code);
            code = at++;
        }
    }
    frame[code] = (uint8_t)(at - code);
    frame[at++] = 0;
    board->write(frame, at);
}

static void rest(btlang_board *board, btlang_channel *channel) {
    memset(&channel->command, 0, sizeof channel->command);
    channel->told = false;
    board->apply(channel);
}

static void rest_all(btlang_board *board) {
    for (uint8_t at = 0; at < board->channel_count; at++)
        if (moves(board->channels[at].kind))
            rest(board, &board->channels[at]);
}

static void say_hello(btlang_board *board, uint16_t before) {
    uint8_t message[BTLANG_MOST];
    uint8_t *at = message;
    size_t length = strlen(board->name);
    *at++ = HELLO;
    *at++ = BTLANG_VERSION;
    *at++ = (uint8_t)length;
    memcpy(at, board->name, length);
    at = put16(put16(at + length, board->session), before);
    for (uint8_t number = 0; number < board->channel_count; number++) {
        const btlang_channel *channel = &board->channels[number];
        *at++ = channel->number;
        *at++ = channel->kind;
        at = put16(at, channel->interval_ms);
    }
    send_frame(board, message, (size_t)(at - message));
}

static void answer(btlang_board *board, uint16_t sequence, uint32_t now_ms, bool samples) {
    uint8_t message[BTLANG_MOST];
    uint8_t *at = message;
    *at++ = ANSWER;
    at = put32(put16(put16(at, board->session), sequence), now_ms);
    for (uint8_t number = 0; samples && number < board->channel_count; number++) {
        const btlang_channel *channel = &board->channels[number];
        size_t size = (size_t)reading_size(channel->kind);
        if (size == 0)
            continue;
        *at++ = channel->number;
        *at++ = channel->kind;
        *at++ = channel->count;
        memcpy(at, channel->reading, size);
        at += size;
    }
    send_frame(board, message, (size_t)(at - message));
}

static btlang_channel *find(btlang_board *board, uint8_t number, uint8_t kind) {
    for (uint8_t at = 0; at < board->channel_count; at++)
        if (board->channels[at].number == number && board->channels[at].kind == kind)
            return &board->channels[at];
    return NULL;
}

static void read_command(btlang_channel *channel, const uint8_t *data) {
    btlang_command *command = &channel->command;
    memset(command, 0, sizeof *command);
    switch (channel->kind) {
    case BTLANG_DRIVE:
        command->drive.left = (int16_t)get16(data);
        command->drive.right = (int16_t)get16(data + 2);
        break;
    case BTLANG_JOINT:
        command->joint.loose = data[0] & LOOSE;
        command->joint.goes = (data[0] & GOES) != 0;
        command->joint.position = (int32_t)get32(data + 1);
        command->joint.speed = get16(data + 5);
        break;
    case BTLANG_LIGHT:
        command->light.red = data[0];
        command->light.green = data[1];
        command->light.blue = data[2];
        break;
    default:
        memcpy(command->text, data, BTLANG_TEXT);
    }
}

/* False where an entry doesn't fit: then nothing of the message is obeyed. */
static bool obey(btlang_board *board, const uint8_t *data, size_t count, uint32_t now_ms, bool really) {
    size_t at = 0;
    while (at < count) {
        btlang_channel *channel = at + 2 <= count ? find(board, data[at], data[at + 1]) : NULL;
        size_t size = channel ? (size_t)command_size(channel->kind) : 0;
        if (size == 0 || at + 2 + size > count)
            return false;
        if (really) {
            read_command(channel, data + at + 2);
            channel->told = moves(channel->kind);
            channel->told_ms = now_ms;
            board->apply(channel);
        }
        at += 2 + size;
    }
    return true;
}

static void handle(btlang_board *board, const uint8_t *message, size_t count, uint32_t now_ms) {
    if (message[0] == STOP && count == 1) {
        rest_all(board);
    } else if (message[0] == ASK_HELLO && count == 4) {
        uint16_t before = board->session, session = get16(message + 2);
        if (session && message[1] == BTLANG_VERSION) {
            board->session = session;
            rest_all(board);
        }
        say_hello(board, before);
    } else if (message[0] == TELL && count >= TELL_HEAD) {
        uint16_t session = get16(message + 1), sequence = get16(message + 3);
        if (session == 0 || session != board->session) {
            answer(board, sequence, now_ms, false);
        } else if (obey(board, message + TELL_HEAD, count - TELL_HEAD, now_ms, false)) {
            obey(board, message + TELL_HEAD, count - TELL_HEAD, now_ms, true);
            answer(board, sequence, now_ms, true);
        }
    }
}

/* COBS, in place: a message is never longer than its frame. Returns its length with the CRC, 0 for none. */
static size_t decode(uint8_t *frame, size_t count) {
    size_t in = 0, out = 0;
    while (in < count) {
        size_t end = in + frame[in];
        if (end > count)
            return 0;
        if (in++ > 0)
            frame[out++] = 0;
        while (in < end)
            frame[out++] = frame[in++];
    }
    return out;
}

bool btlang_begin(btlang_board *board) {
    size_t length = strlen(board->name);
    size_t hello = HELLO_HEAD + length + (size_t)4 * board->channel_count, samples = ANSWER_HEAD;
    for (uint8_t at = 0; at < board->channel_count; at++) {
        btlang_channel *channel = &board->channels[at];
        int size = reading_size(channel->kind);
        if (size < 0)
            return false;
        samples += size > 0 ? (size_t)size + 3 : 0;
        channel->count = 0;
        memset(channel->reading, 0, sizeof channel->reading);
    }
    board->session = 0;
    board->received = 0;
    rest_all(board);
    return length > 0 && length <= BTLANG_NAME && hello + CRC_SIZE <= BTLANG_MOST && samples + CRC_SIZE <= BTLANG_MOST;
}

void btlang_receive(btlang_board *board, uint8_t byte, uint32_t now_ms) {
    if (byte != 0) {
        if (board->received < sizeof board->frame)
            board->frame[board->received++] = byte;
        return;
    }
    size_t count = board->received < sizeof board->frame ? decode(board->frame, board->received) : 0;
    board->received = 0;
    if (count > CRC_SIZE && crc16(board->frame, count - CRC_SIZE) == get16(board->frame + count - CRC_SIZE))
        handle(board, board->frame, count - CRC_SIZE, now_ms);
}

void btlang_turn(btlang_board *board, uint32_t now_ms) {
    for (uint8_t at = 0; at < board->channel_count; at++) {
        btlang_channel *channel = &board->channels[at];
        if (channel->told && now_ms - channel->told_ms >= BTLANG_SILENCE_MS)
            rest(board, channel);
    }
}

void btlang_set_range(btlang_channel *channel, uint16_t mm) {
    put16(channel->reading, mm);
    channel->count++;
}

void btlang_set_drive(btlang_channel *channel, int32_t left_tenths_mm, int32_t right_tenths_mm, int16_t left_mm_s, int16_t right_mm_s) {
    uint8_t *at = put32(put32(channel->reading, (uint32_t)left_tenths_mm), (uint32_t)right_tenths_mm);
    put16(put16(at, (uint16_t)left_mm_s), (uint16_t)right_mm_s);
    channel->count++;
}

void btlang_set_imu(btlang_channel *channel, int32_t turning_centidegrees_s, int16_t ahead_cm_s2, int16_t left_cm_s2,
                    int16_t up_cm_s2, int32_t heading_centidegrees) {
    uint8_t *at = put32(channel->reading, (uint32_t)turning_centidegrees_s);
    at = put16(put16(put16(at, (uint16_t)ahead_cm_s2), (uint16_t)left_cm_s2), (uint16_t)up_cm_s2);
    put32(at, (uint32_t)heading_centidegrees);
    channel->count++;
}

void btlang_set_battery(btlang_channel *channel, uint16_t hundredths_percent, uint16_t millivolts, int16_t centiamperes,
                        int16_t tenths_celsius, uint8_t charging) {
    uint8_t *at = put16(put16(channel->reading, hundredths_percent), millivolts);
    at = put16(put16(at, (uint16_t)centiamperes), (uint16_t)tenths_celsius);
    *at = charging;
    channel->count++;
}

void btlang_set_button(btlang_channel *channel, bool pressed) {
    channel->reading[0] = pressed;
    channel->count++;
}

void btlang_set_joint(btlang_channel *channel, int32_t centidegrees, int16_t tenths_degrees_s, int8_t load_percent,
                      int8_t celsius, bool loose) {
    uint8_t *at = put16(put32(channel->reading, (uint32_t)centidegrees), (uint16_t)tenths_degrees_s);
    *at++ = (uint8_t)load_percent;
    *at++ = (uint8_t)celsius;
    *at = loose;
    channel->count++;
}
