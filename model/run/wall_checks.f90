!> Mistakes of walls that only the rest of the case shows: whether they are met at all, and fillings beyond them.
module wall_checks
  use case, only: case_t
  use case_keys, only: keys_t
  use constants, only: is_set
  use kinds, only: wp
  use plane, only: plane_t, new_plane
  use shell, only: shell_t, new_shell, find_rim
  use wall_motion, only: cross
  use wall_settings, only: wall_settings_t
  implicit none
  private
  public :: check_walls

  real(wp), parameter :: closeness = 1.0e-6_wp  !< of the domain: what counts as lying on a plane
  real(wp), parameter :: parallel = 1.0e-12_wp  !< [rad]

contains

  !> Add to keys%problems; the corners of the domain are known.
  subroutine check_walls(case, keys)
    type(case_t), intent(in) :: case
    type(keys_t), intent(inout) :: keys

    integer :: i

    do i = 1, size(case%walls)
      call keys%require_at(case%with_gas .or. .not. case%walls(i)%blocks_gas(), 'wall', i, 'gas_side', 'there is no &gas')
      call keys%require_at(case%with_parcels .or. case%walls(i)%blocks_gas(), 'wall', i, '', &
                           'nothing meets it: there are no &parcels, and the gas passes through it; see gas_side')
      if (.not. case%walls(i)%has_shape()) cycle
      if (case%walls(i)%kind == 'plane') then
        call check_plane(case, i, keys)
      else
        call check_shell(case, i, keys)
      end if
    end do
  end subroutine check_walls

  subroutine check_plane(case, i, keys)
    type(case_t), intent(in) :: case
    integer, intent(in) :: i
    type(keys_t), intent(inout) :: keys

    type(plane_t) :: plane
    real(wp) :: d(8), near
    integer :: f

    plane = new_plane(case%walls(i))
    near = closeness*maxval(case%domain%upper - case%domain%lower)
    d = distances(plane, case%domain%lower, case%domain%upper)
    call keys%require_at(minval(d) <= near, 'wall', i, '', 'lies outside the domain: no parcel gets there')
    call keys%require_at(maxval(d) > near, 'wall', i, '', 'leaves no room: all of the domain is beyond it')
    call keys%require_at(maxval(d) <= near .or. minval(d) > near .or. count(abs(d) <= near) < 4, 'wall', i, '', &
                         'lies on a face of the domain, where parcels would feel both: move it inside, or the face outward')
    do f = 1, 3
      if (case%domain%periodic(f)) call keys%require_at(abs(plane%normal(f)) <= parallel, 'wall', i, 'normal', &
                                                        'the plane must run along the periodic direction '//'xyz'(f:f))
    end do
    do f = 1, size(case%fills)
      associate (fill => case%fills(f))
        if (.not. has_box(fill%lower, fill%upper)) cycle
        call keys%require_at(minval(distances(plane, fill%lower, fill%upper)) >= -near, 'fill', f, '', 'its box reaches beyond ' &
                             //label(case%walls(i)))
      end associate
    end do
  end subroutine check_plane

  subroutine check_shell(case, i, keys)
    type(case_t), intent(in) :: case
    integer, intent(in) :: i
    type(keys_t), intent(inout) :: keys

    type(shell_t) :: shell
    real(wp) :: unit(3)
    integer :: f

    shell = new_shell(case%walls(i))
    if (shell%has_ends) then
      call check_ends(case, i, shell, keys)
    else
      call check_endless(case, i, shell, keys)
    end if
    do f = 1, 3
      if (.not. case%domain%periodic(f)) cycle
      unit = 0.0_wp
      unit(f) = 1.0_wp
      call keys%require_at(.not. shell%has_ends .and. norm2(cross(unit, shell%axis)) <= parallel, 'wall', i, 'kind', &
                           'in a domain periodic in '//'xyz'(f:f)//' a cylinder must run along '//'xyz'(f:f)//', without a length')
    end do
    do f = 1, size(case%fills)
      associate (fill => case%fills(f))
        if (.not. has_box(fill%lower, fill%upper)) cycle
        call keys%require_at(is_clear(shell, fill%lower, fill%upper), 'fill', f, '', 'its box reaches through ' &
                             //label(case%walls(i)))
      end associate
    end do
  end subroutine check_shell

  !> A wall with ends lies in the domain.
  subroutine check_ends(case, i, shell, keys)
    type(case_t), intent(in) :: case
    integer, intent(in) :: i
    type(shell_t), intent(in) :: shell
    type(keys_t), intent(inout) :: keys

    real(wp) :: centre(3), radius, reach(3), near(3)
    logical :: inside
    integer :: end

    near = closeness*(case%domain%upper - case%domain%lower)
    inside = .true.
    do end = 1, 2
      call find_rim(shell, end, centre, radius)
      reach = radius*sqrt(max(0.0_wp, 1 - shell%axis**2)) - near
      inside = inside .and. all(centre - reach >= case%domain%lower) .and. all(centre + reach <= case%domain%upper)
    end do
    call keys%require_at(inside, 'wall', i, '', 'reaches out of the domain')
  end subroutine check_ends

  !> A cylinder without ends has a part of the domain on either side.
  subroutine check_endless(case, i, shell, keys)
    type(case_t), intent(in) :: case
    integer, intent(in) :: i
    type(shell_t), intent(in) :: shell
    type(keys_t), intent(inout) :: keys

    logical :: all_inside, all_outside

    associate (domain => case%domain)
      all_inside = lies_inside(shell, domain%lower, domain%upper)
      all_outside = way_from_axis(shell, domain%lower, domain%upper) >= shell%radius
    end associate
    call keys%require_at(.not. merge(all_inside, all_outside, shell%side > 0), 'wall', i, '', &
                         'lies outside the domain: no parcel gets there')
    call keys%require_at(.not. merge(all_outside, all_inside, shell%side > 0), 'wall', i, '', &
                         'leaves no room: all of the domain is beyond it')
  end subroutine check_endless

  !> Whether a box is on one side of a shell, and the right one if there is one. Outside a cone, farther than its widest.
  pure function is_clear(shell, lower, upper)
    type(shell_t), intent(in) :: shell
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    logical :: is_clear

    real(wp) :: heights(8), height, widest
    logical :: inside, outside

    inside = lies_inside(shell, lower, upper)
    height = shell%length*shell%generator(1)
    widest = max(shell%radius, shell%radius + shell%length*shell%generator(2))
    outside = way_from_axis(shell, lower, upper) >= widest*(1 - closeness)
    if (shell%has_ends) then
      heights = heights_of(shell, lower, upper)
      is_clear = inside .or. outside .or. all(heights <= closeness*height) .or. all(heights >= (1 - closeness)*height)
    else
      is_clear = merge(inside, outside, shell%side > 0)
    end if
  end function is_clear

  !> Whether a box is within a shell, prolonged beyond its ends: a convex body, so its corners tell.
  pure function lies_inside(shell, lower, upper)
    type(shell_t), intent(in) :: shell
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    logical :: lies_inside

    real(wp) :: x(3, 8), height
    integer :: c

    x = corners(lower, upper)
    lies_inside = .true.
    do c = 1, 8
      height = dot_product(x(:, c) - shell%point, shell%axis)
      lies_inside = lies_inside .and. norm2(x(:, c) - shell%point - height*shell%axis) &
                    <= shell%radius + height*shell%generator(2)/shell%generator(1) + closeness*norm2(upper - lower)
    end do
  end function lies_inside

  !> Least distance of a box from the axis of a shell, between its ends: convex along the axis [m].
  pure function way_from_axis(shell, lower, upper) result(least)
    type(shell_t), intent(in) :: shell
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    real(wp) :: least

    real(wp) :: range(2), third, way(2), heights(8)
    integer :: step, m

    heights = heights_of(shell, lower, upper)
    range = [minval(heights), maxval(heights)]
    if (shell%has_ends) range = min(max(range, 0.0_wp), shell%length*shell%generator(1))
    least = huge(least)
    do step = 1, 100
      third = (range(2) - range(1))/3
      do m = 1, 2
        way(m) = way_to_box(shell%point + (range(1) + m*third)*shell%axis, lower, upper)
      end do
      least = min(least, minval(way))
      if (way(1) < way(2)) range(2) = range(2) - third
      if (way(1) >= way(2)) range(1) = range(1) + third
    end do
  end function way_from_axis

  !> Of the corners of a box along the axis of a shell [m].
  pure function heights_of(shell, lower, upper) result(heights)
    type(shell_t), intent(in) :: shell
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    real(wp) :: heights(8)

    real(wp) :: x(3, 8)
    integer :: c

    x = corners(lower, upper)
    heights = [(dot_product(x(:, c) - shell%point, shell%axis), c=1, 8)]
  end function heights_of

  pure function way_to_box(x, lower, upper) result(way)
    real(wp), intent(in) :: x(3), lower(3), upper(3)  !< [m]
    real(wp) :: way

    way = norm2(x - min(max(x, lower), upper))
  end function way_to_box

  !> Of the corners of a box from a plane [m].
  pure function distances(plane, lower, upper)
    type(plane_t), intent(in) :: plane
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    real(wp) :: distances(8)

    real(wp) :: x(3, 8)
    integer :: c

    x = corners(lower, upper)
    distances = [(plane%distance(x(:, c)), c=1, 8)]
  end function distances

  pure function corners(lower, upper) result(x)
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    real(wp) :: x(3, 8)

    integer :: c

    do c = 1, 8
      x(:, c) = merge(upper, lower, [btest(c, 0), btest(c, 1), btest(c, 2)])
    end do
  end function corners

  pure function has_box(lower, upper)
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    logical :: has_box

    has_box = all(is_set([lower, upper]))
    if (has_box) has_box = all(upper >= lower)
  end function has_box

  pure function label(wall) result(name)
    type(wall_settings_t), intent(in) :: wall
    character(len=:), allocatable :: name

    name = '&wall('//trim(wall%id)//')'
  end function label

end module wall_checks
