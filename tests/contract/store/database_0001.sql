BEGIN TRANSACTION;
CREATE TABLE alembic_version (
	version_num VARCHAR(32) NOT NULL, 
	CONSTRAINT alembic_version_pkc PRIMARY KEY (version_num)
);
INSERT INTO "alembic_version" VALUES('0001');
CREATE TABLE artifacts (
	job_id VARCHAR(36) NOT NULL, 
	name VARCHAR(255) NOT NULL, 
	media_type VARCHAR(255) NOT NULL, 
	size INTEGER NOT NULL, 
	sha256 VARCHAR(64) NOT NULL, 
	data BLOB NOT NULL, 
	CONSTRAINT pk_artifacts PRIMARY KEY (job_id, name), 
	CONSTRAINT fk_artifacts_job_id FOREIGN KEY(job_id) REFERENCES jobs (id)
);
INSERT INTO "artifacts" VALUES('d825fd1a-3711-4e7f-8c44-296da7344595','map.png','image/png',8,'4c4b6a3be1314ab86138bef4314dde022e600960d8689a2c8f8631802d20dab6',X'89504E470D0A1A0A');
CREATE TABLE events (
	id INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT, 
	job_id VARCHAR(36) NOT NULL, 
	at DATETIME NOT NULL, 
	kind VARCHAR(16) NOT NULL, 
	data JSON NOT NULL, 
	CONSTRAINT fk_events_job_id FOREIGN KEY(job_id) REFERENCES jobs (id)
);
INSERT INTO "events" VALUES(1,'d825fd1a-3711-4e7f-8c44-296da7344595','2026-11-22 16:08:47.586000','status','{"status":"accepted"}');
INSERT INTO "events" VALUES(2,'f248f370-a197-4a16-a9ab-612a1932ac6a','2026-11-22 16:08:47.592000','status','{"status":"accepted"}');
INSERT INTO "events" VALUES(3,'d825fd1a-3711-4e7f-8c44-296da7344595','2026-11-22 16:08:47.604000','status','{"status":"running","attempt":1}');
INSERT INTO "events" VALUES(4,'d825fd1a-3711-4e7f-8c44-296da7344595','2026-11-22 16:08:47.608000','progress','{"progress":40.0,"message":"row","eta_s":1.0}');
INSERT INTO "events" VALUES(5,'d825fd1a-3711-4e7f-8c44-296da7344595','2026-11-22 16:08:47.612000','status','{"status":"successful"}');
CREATE TABLE jobs (
	seq INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT, 
	id VARCHAR(36) NOT NULL, 
	process_id VARCHAR(100) NOT NULL, 
	status VARCHAR(16) NOT NULL, 
	priority INTEGER NOT NULL, 
	inputs JSON NOT NULL, 
	instant JSON, 
	idempotency_key VARCHAR(255), 
	request_sha256 VARCHAR(64) NOT NULL, 
	progress DOUBLE NOT NULL, 
	message TEXT NOT NULL, 
	eta_s DOUBLE, 
	attempts INTEGER NOT NULL, 
	cancel_requested BOOLEAN NOT NULL, 
	timeout_s DOUBLE NOT NULL, 
	owner VARCHAR(255), 
	token INTEGER NOT NULL, 
	lease_expires_at DATETIME, 
	created_at DATETIME NOT NULL, 
	started_at DATETIME, 
	finished_at DATETIME, 
	updated_at DATETIME NOT NULL, 
	problem JSON, 
	versions JSON, 
	CONSTRAINT uq_jobs_id UNIQUE (id), 
	CONSTRAINT uq_jobs_idempotency_key UNIQUE (idempotency_key)
);
INSERT INTO "jobs" VALUES(1,'d825fd1a-3711-4e7f-8c44-296da7344595','benchmark','successful',0,'{"omega_t_deg_s":3,"a_max_m_s2":0.1,"grid":{"nx":5,"ny":5},"engines":["analytical"]}',NULL,NULL,'450d99877b2dd2388ff59662916886003325a87633ba2cf0901c31ef6c3d8ce8',100.0,'done',NULL,1,0,60.0,NULL,1,NULL,'2026-11-22 16:08:47.584000','2026-11-22 16:08:47.603000','2026-11-22 16:08:47.611000','2026-11-22 16:08:47.611000',NULL,'{"safestart":"0.1.0"}');
INSERT INTO "jobs" VALUES(2,'f248f370-a197-4a16-a9ab-612a1932ac6a','benchmark','accepted',0,'{"omega_t_deg_s":3,"a_max_m_s2":0.1,"grid":{"nx":5,"ny":5},"engines":["analytical"]}',NULL,NULL,'450d99877b2dd2388ff59662916886003325a87633ba2cf0901c31ef6c3d8ce8',0.0,'',NULL,0,0,60.0,NULL,0,NULL,'2026-11-22 16:08:47.591000',NULL,NULL,'2026-11-22 16:08:47.591000',NULL,NULL);
CREATE TABLE results (
	job_id VARCHAR(36) NOT NULL, 
	schema_version INTEGER NOT NULL, 
	document JSON NOT NULL, 
	sha256 VARCHAR(64) NOT NULL, 
	created_at DATETIME NOT NULL, 
	CONSTRAINT pk_results PRIMARY KEY (job_id), 
	CONSTRAINT fk_results_job_id FOREIGN KEY(job_id) REFERENCES jobs (id)
);
INSERT INTO "results" VALUES('d825fd1a-3711-4e7f-8c44-296da7344595',1,'{"schema_version":1,"inputs":{"omega_t_deg_s":3,"a_max_m_s2":0.1,"grid":{"nx":5,"ny":5},"engines":["analytical"]},"outputs":{"rows":[{"engine":"analytical","area_m2":12.5}]},"provenance":{"seed":0}}','536816f4101c3a18d0ee8156e57fa313250368105b9015cc3e673d2c7bcf1a10','2026-11-22 16:08:47.613000');
CREATE TABLE workers (
	owner VARCHAR(255) NOT NULL, 
	capacity INTEGER NOT NULL, 
	busy INTEGER NOT NULL, 
	heartbeat_at DATETIME NOT NULL, 
	CONSTRAINT pk_workers PRIMARY KEY (owner)
);
CREATE INDEX ix_jobs_queue ON jobs (status, priority, seq);
CREATE INDEX ix_events_job_id_id ON events (job_id, id);
DELETE FROM "sqlite_sequence";
INSERT INTO "sqlite_sequence" VALUES('jobs',2);
INSERT INTO "sqlite_sequence" VALUES('events',5);
COMMIT;
