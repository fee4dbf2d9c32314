<?xml version="1.0" encoding="UTF-8"?>
<tileset version="1.10" tiledversion="1.11.0" name="valley" tilewidth="16" tileheight="16" tilecount="4" columns="2">
 <image source="valley.png" width="32" height="32"/>
 <tile id="0" type="ground"/>
 <tile id="1" type="Goomba">
  <properties>
   <property name="speed" type="float" value="-24"/>
  </properties>
 </tile>
</tileset>
