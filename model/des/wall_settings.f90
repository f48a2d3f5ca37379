!> A &wall record: a plane, cylinder, cone or mesh of triangles within the domain that parcels bounce off.
module wall_settings
  use case_keys, only: keys_t
  use constants, only: unset, is_set
  use kinds, only: wp
  use text, only: word_length, line_length
  use wall_motion, only: wall_motion_t, cross
  implicit none
  private
  public :: wall_settings_t, declare_wall

  real(wp), parameter :: slant = 1.0e-3_wp  !< between directions that count as one [rad]

  type :: wall_settings_t
    character(len=word_length) :: id = ''
    character(len=word_length) :: kind = ''         !< 'plane' | 'cylinder' | 'cone' | 'mesh'
    real(wp) :: point(3) = unset                    !< of the plane, or of the axis [m]
    real(wp) :: normal(3) = unset                   !< plane: towards the parcels, of any length
    real(wp) :: axis(3) = unset                     !< cylinder: of any length
    real(wp) :: radius = unset                      !< cylinder: everywhere, cone: at `point` [m]
    real(wp) :: length = unset                      !< cylinder: along the axis from `point` [m]; unset: without ends
    character(len=word_length) :: side = 'inside'   !< cylinder without ends: where parcels are, or 'outside'
    character(len=word_length) :: gas_side = 'both'  !< where the gas is: 'both', and passes through, 'inside' or 'outside'
    real(wp) :: end_point(3) = unset                !< cone: another point of the axis [m]
    real(wp) :: end_radius = unset                  !< cone: there [m]
    character(len=line_length) :: file = ''         !< mesh: .stl
    real(wp) :: scale = 1.0_wp                      !< mesh: length of the file's unit [m]
    real(wp) :: offset(3) = 0.0_wp                  !< mesh: where the file's origin is at the start [m]
    logical :: open = .false.                       !< mesh: whether it may have edges
    logical :: stays = .false.                      !< mesh: whether only its surface moves
    real(wp) :: velocity(3) = 0.0_wp                !< of the surface, along itself; of a mesh that does not stay [m/s]
    real(wp) :: angular_velocity(3) = 0.0_wp        !< of the surface, onto itself; of a mesh that does not stay [rad/s]
    real(wp) :: rotation_centre(3) = unset          !< [m]
    character(len=word_length) :: material_id = ''  !< key material
    integer :: material = 0                         !< place of that record; 0: that of all walls
  contains
    procedure :: has_length
    procedure :: has_shape
    procedure :: blocks_gas
    procedure :: direction
    procedure :: motion
  end type wall_settings_t

contains

  !> The keys of the open record.
  subroutine declare_wall(settings, keys)
    type(wall_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    logical :: plane, cylinder, cone, mesh

    call keys%get_id(settings%id, 'name of the wall')
    call keys%get('kind', settings%kind, 'what it is; parcels are on one side of a plane or a cylinder without length, and on '// &
                  'either of others', 'plane | cylinder | cone | mesh', required=.true., when='always')
    plane = settings%kind == 'plane'
    cylinder = settings%kind == 'cylinder'
    cone = settings%kind == 'cone'
    mesh = settings%kind == 'mesh'
    call keys%get('point', settings%point, 'a point of the plane or of the axis; where a length or a cone begins [m]', &
                  required=.not. mesh, when='for all but a mesh')
    call keys%get('normal', settings%normal, 'plane: direction towards the parcels', required=plane, when='for a plane')
    call keys%get('axis', settings%axis, 'cylinder: direction of its axis', required=cylinder, when='for a cylinder')
    call keys%get('radius', settings%radius, 'of the cylinder, or of the cone at point [m]', '[0, inf)', &
                  required=cylinder .or. cone, when='for a cylinder and a cone')
    call keys%get('length', settings%length, 'cylinder: along the axis from point; without end if not given [m]', '(0, inf)')
    call keys%get('side', settings%side, 'cylinder without length: where the parcels are', 'inside | outside')
    call keys%get('gas_side', settings%gas_side, 'where the gas is; on both sides it passes through the wall; inside '// &
                  'of a plane is where its normal points; a mesh must be closed, or end on or beyond faces of the '// &
                  'domain', 'both | inside | outside')
    call keys%get('end_point', settings%end_point, 'cone: the other end of its axis [m]', required=cone, when='for a cone')
    call keys%get('end_radius', settings%end_radius, 'cone: radius at end_point [m]', '[0, inf)', required=cone, when='for a cone')
    call keys%get_path('file', settings%file, 'mesh: its triangles, .stl', must_exist=.true.)
    call keys%get('scale', settings%scale, 'mesh: length of the file''s unit [m]', '(0, inf)')
    call keys%get('offset', settings%offset, 'mesh: where the origin of the file is at the start [m]')
    call keys%get('open', settings%open, 'mesh: whether it may have edges, as a chute has, and not enclose anything')
    call keys%get('stays', settings%stays, 'mesh: whether it stays where it is and only its surface moves')
    call keys%get('velocity', settings%velocity, 'of the surface, along the wall, which stays where it is: a belt; a mesh '// &
                  'moves as a whole [m/s]')
    call keys%get('angular_velocity', settings%angular_velocity, 'of the surface, about the axis of the wall or the normal '// &
                  'of the plane: a drum; a mesh turns as a whole [rad/s]')
    settings%rotation_centre = settings%point
    if (mesh) settings%rotation_centre = settings%offset
    call keys%get('rotation_centre', settings%rotation_centre, 'a point of the axis of rotation; point, or offset of a mesh, '// &
                  'if not given [m]')
    call keys%get_optional_reference('material', settings%material_id, settings%material, 'material', &
                                     'what it is made of, a &material; wall_material of &contact if not given')
    call keys%require(.not. mesh .or. keys%given('file'), 'file', 'is missing; it is required for a mesh')
    call check_keys(settings, keys)
    if (settings%has_shape()) call check_motion(settings, keys)
    if (settings%blocks_gas()) call check_gas_side(settings, keys)
  end subroutine declare_wall

  !> Each kind has its own keys, and directions have a length.
  subroutine check_keys(settings, keys)
    type(wall_settings_t), intent(in) :: settings
    type(keys_t), intent(inout) :: keys

    if (len_trim(settings%kind) == 0) return
    call reserve('normal', 'plane')
    call reserve('axis', 'cylinder')
    call reserve('length', 'cylinder')
    call reserve('side', 'cylinder')
    call reserve('end_point', 'cone')
    call reserve('end_radius', 'cone')
    call reserve('file', 'mesh')
    call reserve('scale', 'mesh')
    call reserve('offset', 'mesh')
    call reserve('open', 'mesh')
    call reserve('stays', 'mesh')
    call keys%require(.not. (keys%given('radius') .and. any(settings%kind == ['plane', 'mesh '])), 'radius', &
                      'belongs to a cylinder or a cone')
    call keys%require(.not. (keys%given('point') .and. settings%kind == 'mesh'), 'point', &
                      'belongs to a plane, a cylinder or a cone; a mesh has an offset')
    call demand_direction('normal', settings%normal)
    call demand_direction('axis', settings%axis)
    if (settings%kind == 'cylinder') then
      call keys%require(.not. (keys%given('side') .and. keys%given('length')), 'side', &
                        'a cylinder with a length has parcels on both sides')
      if (is_set(settings%radius)) call keys%require(settings%radius > 0.0_wp, 'radius', 'must be positive')
    else if (settings%kind == 'cone' .and. all(is_set([settings%point, settings%end_point]))) then
      call keys%require(norm2(settings%end_point - settings%point) > 0.0_wp, 'end_point', 'must differ from point')
      if (all(is_set([settings%radius, settings%end_radius]))) then
        call keys%require(max(settings%radius, settings%end_radius) > 0.0_wp, 'end_radius', 'one of the radii must be positive')
      end if
    end if

  contains

    subroutine reserve(name, kind)
      character(len=*), intent(in) :: name, kind

      call keys%require(.not. keys%given(name) .or. settings%kind == kind, name, 'belongs to a '//kind)
    end subroutine reserve

    subroutine demand_direction(name, vector)
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: vector(3)

      if (all(is_set(vector))) call keys%require(norm2(vector) > 0.0_wp, name, 'must not be zero')
    end subroutine demand_direction
  end subroutine check_keys

  !> The gas is where the parcels are, and a wall that keeps it stays where it is.
  subroutine check_gas_side(settings, keys)
    type(wall_settings_t), intent(in) :: settings
    type(keys_t), intent(inout) :: keys

    type(wall_motion_t) :: motion

    motion = wall_motion_t(settings%velocity, settings%angular_velocity, [0.0_wp, 0.0_wp, 0.0_wp])
    call keys%require(settings%kind /= 'mesh' .or. settings%stays .or. motion%is_still(), 'gas_side', &
                      'a mesh that the gas does not pass through cannot move as a whole: see stays')
    call keys%require(settings%kind /= 'plane' .or. settings%gas_side == 'inside', 'gas_side', &
                      'of a plane the gas is where the parcels are: inside')
    call keys%require(settings%kind /= 'cylinder' .or. settings%has_length() .or. settings%gas_side == settings%side, 'gas_side', &
                      'of a cylinder without length the gas is where the parcels are: see side')
  end subroutine check_gas_side

  !> The surface moves and the wall does not.
  subroutine check_motion(settings, keys)
    type(wall_settings_t), intent(in) :: settings
    type(keys_t), intent(inout) :: keys

    real(wp) :: direction(3), along

    direction = settings%direction()
    associate (v => settings%velocity, spin => settings%angular_velocity, arm => settings%rotation_centre - settings%point)
      along = abs(dot_product(v, direction))
      if (settings%kind == 'plane') then
        call keys%require(along <= slant*norm2(v), 'velocity', 'must lie in the plane: the wall stays where it is')
        call keys%require(norm2(cross(spin, direction)) <= slant*norm2(spin), 'angular_velocity', &
                          'must be along the normal: the wall stays where it is')
        return
      end if
      if (settings%kind == 'cone' .or. settings%has_length()) then
        call keys%require(.not. norm2(v) > 0.0_wp, 'velocity', 'a wall with ends cannot move along itself')
      else
        call keys%require(norm2(cross(v, direction)) <= slant*norm2(v), 'velocity', &
                          'must be along the axis: the wall stays where it is')
      end if
      call keys%require(norm2(cross(spin, direction)) <= slant*norm2(spin), 'angular_velocity', &
                        'must be along the axis: the wall stays where it is')
      if (all(is_set(settings%rotation_centre))) call keys%require(norm2(cross(arm, direction)) <= slant*settings%radius, &
                                                                   'rotation_centre', 'must lie on the axis')
    end associate
  end subroutine check_motion

  !> Whether there is no gas on one side.
  pure function blocks_gas(self)
    class(wall_settings_t), intent(in) :: self
    logical :: blocks_gas

    blocks_gas = self%gas_side /= 'both'
  end function blocks_gas

  pure function has_length(self)
    class(wall_settings_t), intent(in) :: self
    logical :: has_length

    has_length = is_set(self%length)
  end function has_length

  !> Whether all is there, and right, that makes the shape.
  pure function has_shape(self)
    class(wall_settings_t), intent(in) :: self
    logical :: has_shape

    has_shape = all(is_set(self%point))
    select case (self%kind)
    case ('plane')
      has_shape = has_shape .and. all(is_set(self%normal))
    case ('cylinder')
      has_shape = has_shape .and. all(is_set([self%axis, self%radius])) .and. self%radius > 0.0_wp
    case ('cone')
      has_shape = has_shape .and. all(is_set([self%end_point, self%radius, self%end_radius]))
      has_shape = has_shape .and. max(self%radius, self%end_radius) > 0.0_wp
    case default
      has_shape = .false.
    end select
    if (has_shape) has_shape = norm2(self%direction()) > 0.0_wp
  end function has_shape

  !> Unit vector of the normal or the axis; zero if that is.
  pure function direction(self)
    class(wall_settings_t), intent(in) :: self
    real(wp) :: direction(3)

    select case (self%kind)
    case ('plane')
      direction = self%normal
    case ('cone')
      direction = self%end_point - self%point
    case default
      direction = self%axis
    end select
    if (norm2(direction) > 0.0_wp) direction = direction/norm2(direction)
  end function direction

  !> The motion of the surface, without what a rounded direction has beside it; that of a mesh as it is.
  pure function motion(self)
    class(wall_settings_t), intent(in) :: self
    type(wall_motion_t) :: motion

    real(wp) :: direction(3)

    if (self%kind == 'mesh') then
      motion = wall_motion_t(self%velocity, self%angular_velocity, self%rotation_centre)
      return
    end if
    direction = self%direction()
    motion%spin = dot_product(self%angular_velocity, direction)*direction
    motion%velocity = dot_product(self%velocity, direction)*direction
    if (self%kind == 'plane') then
      motion%velocity = self%velocity - motion%velocity
      motion%centre = self%rotation_centre
    else
      motion%centre = self%point
    end if
  end function motion

end module wall_settings
