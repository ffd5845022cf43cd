BEGIN TRANSACTION;
CREATE TABLE act (
            number BIGINT PRIMARY KEY, time DOUBLE PRECISION NOT NULL, person TEXT NOT NULL, command TEXT NOT NULL,
            details TEXT NOT NULL, outcome TEXT NOT NULL
        );
INSERT INTO "act" VALUES(1,3.0,'ada','say','it''s','said');
CREATE TABLE change (
            number BIGINT PRIMARY KEY, task BIGINT NOT NULL, time DOUBLE PRECISION NOT NULL, state TEXT NOT NULL,
            cause TEXT NOT NULL, person TEXT NOT NULL
        );
INSERT INTO "change" VALUES(1,1,1.25,'blocked','submitted','ada');
INSERT INTO "change" VALUES(2,2,100.0,'queued','','ada');
CREATE TABLE counter (name TEXT PRIMARY KEY, value BIGINT NOT NULL);
INSERT INTO "counter" VALUES('task',2);
INSERT INTO "counter" VALUES('change',2);
INSERT INTO "counter" VALUES('schedule',1);
INSERT INTO "counter" VALUES('act',1);
CREATE TABLE revision (
            name TEXT NOT NULL, number BIGINT NOT NULL, text TEXT NOT NULL, person TEXT NOT NULL,
            time DOUBLE PRECISION NOT NULL, deleted BIGINT NOT NULL, PRIMARY KEY (name, number)
        );
INSERT INTO "revision" VALUES('tour',1,'wave','ada',1.0,0);
INSERT INTO "revision" VALUES('tour',2,'','bo',2.0,1);
CREATE TABLE schedule (
            id BIGINT PRIMARY KEY, rule TEXT NOT NULL, zone TEXT NOT NULL, mission TEXT NOT NULL, person TEXT NOT NULL,
            created DOUBLE PRECISION NOT NULL, next DOUBLE PRECISION, priority BIGINT NOT NULL, labels TEXT NOT NULL,
            restart TEXT NOT NULL, overlap TEXT NOT NULL, missed TEXT NOT NULL, within DOUBLE PRECISION
        );
INSERT INTO "schedule" VALUES(1,'every day at 9:00','Europe/Berlin','{"text": "wave", "name": "", "revision": 0, "values": {"n": 1}}','bo',1.5,10.0,5,'[
"a",
"b"
]','again','replace','once',600.0);
CREATE TABLE setting (name TEXT PRIMARY KEY, value TEXT NOT NULL);
INSERT INTO "setting" VALUES('paused','no');
CREATE TABLE task (
            id BIGINT PRIMARY KEY, mission TEXT NOT NULL, person TEXT NOT NULL, created DOUBLE PRECISION NOT NULL,
            state TEXT NOT NULL, priority BIGINT NOT NULL, labels TEXT NOT NULL, earliest DOUBLE PRECISION,
            deadline DOUBLE PRECISION, restart TEXT NOT NULL, needs TEXT NOT NULL, schedule BIGINT NOT NULL,
            due DOUBLE PRECISION, position BIGINT NOT NULL, attempts BIGINT NOT NULL, started DOUBLE PRECISION,
            ended DOUBLE PRECISION, reason TEXT NOT NULL, saved TEXT NOT NULL, token TEXT NOT NULL,
            recording TEXT NOT NULL
        );
INSERT INTO "task" VALUES(1,'{"text": "go to the lab\nthen wave", "name": "tour", "revision": 3, "values": {"speed": 0.5, "names": ["\u00d6", "\u0000"]}}','ada',1.25,'blocked',-7,'[
"night",
"the \"lab\"",
"a\nb"
]',2.5,3.5,'resume','[
"base",
"voice"
]',4,5.5,6,7,8.5,9.5,'it''s dark 🌙','{"tree": 1}','t0ken','runs/1.mcap');
INSERT INTO "task" VALUES(2,'{"text": "wave", "name": "", "revision": 0, "values": {}}','ada',100.0,'queued',0,'[]',NULL,NULL,'give up','[]',0,NULL,0,0,NULL,NULL,'','','','');
CREATE TABLE version (number BIGINT NOT NULL);
INSERT INTO "version" VALUES(1);
CREATE INDEX task_turn ON task (priority DESC, position, id)
            WHERE state NOT IN ('canceled', 'completed', 'error', 'failed', 'killed', 'skipped');
CREATE INDEX change_task ON change (task, number);
COMMIT;
