!> What becomes of the parts of the gas that walls keep from each other.
!>
!> Where there is an outflow, parts that it does not drain are closed: gas that cannot expand has no way in them but round. Without
!> one each part has a pressure of its own.
module gas_parts
  use boxes, only: boxes_t
  use free_levels, only: free_levels_t
  use gas_boundary, only: gas_boundary_t
  use kinds, only: wp
  use mesh, only: mesh_t
  use open_parts, only: open_parts_t, find_parts
  use open_space, only: open_space_t
  use outcome, only: outcome_t, exit_input
  use text, only: brief
  implicit none
  private
  public :: settle_parts

contains

  !> Close what no outflow drains, or find the levels of parts if there is no outflow. A part into which gas flows and that has
  !> no way out is a mistake.
  subroutine settle_parts(boxes, mesh, boundary, space, levels, outcome)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(gas_boundary_t), intent(in) :: boundary
    type(open_space_t), intent(inout) :: space
    type(free_levels_t), intent(out) :: levels
    type(outcome_t), intent(inout) :: outcome

    type(open_parts_t) :: parts
    logical, allocatable :: drained(:), fed(:)
    logical, allocatable :: shut(:,:,:)
    integer :: p

    call find_parts(boxes, space, parts)
    if (.not. boundary%any_open) then
      call level_parts(boxes, parts, levels)
      return
    end if
    call find_ways(boxes, boundary, space, parts, drained, fed)
    do p = 1, parts%n
      if (drained(p) .or. .not. fed(p)) cycle
      call outcome%fail(exit_input, 'gas flows into a part of the domain that walls keep from every outflow, the one about (' &
                        //place_of(mesh, parts%first(:, p))//') m')
      return
    end do
    if (all(drained)) return
    allocate (shut(-1:ubound(parts%part, 1), -1:ubound(parts%part, 2), -1:ubound(parts%part, 3)), source=.false.)
    do p = 1, parts%n
      if (.not. drained(p)) shut = shut .or. parts%part == p
    end do
    space%pockets = count(.not. drained)
    p = findloc(drained, .false., dim=1)
    space%pocket_place = mesh%in_metres(parts%first(:, p) - 0.5_wp)
    call space%shut_off(boxes, mesh, shut)
  end subroutine settle_parts

  pure function place_of(mesh, cell) result(words)
    type(mesh_t), intent(in) :: mesh
    integer, intent(in) :: cell(3)
    character(len=:), allocatable :: words

    associate (x => mesh%in_metres(cell - 0.5_wp))
      words = brief(x(1))//', '//brief(x(2))//', '//brief(x(3))
    end associate
  end function place_of

  subroutine level_parts(boxes, parts, levels)
    type(boxes_t), intent(in) :: boxes
    type(open_parts_t), intent(in) :: parts
    type(free_levels_t), intent(out) :: levels

    integer :: p

    levels%n = parts%n
    allocate (levels%cell(3, parts%n), levels%cells(parts%n))
    do p = 1, parts%n
      levels%cell(:, p) = parts%first(:, p) + 1 - boxes%lo
    end do
    associate (part => parts%part(1:boxes%n(1), 1:boxes%n(2), 1:boxes%n(3)))
      levels%cells(:) = boxes%comm%sum([(real(count(part == p), wp), p=1, parts%n)])
      if (parts%n > 1) allocate (levels%part, source=part)
    end associate
  end subroutine level_parts

  !> Which parts have an outflow, and into which gas flows.
  subroutine find_ways(boxes, boundary, space, parts, drained, fed)
    type(boxes_t), intent(in) :: boxes
    type(gas_boundary_t), intent(in) :: boundary
    type(open_space_t), intent(in) :: space
    type(open_parts_t), intent(in) :: parts
    logical, allocatable, intent(out) :: drained(:), fed(:)

    real(wp) :: ways(2, parts%n)
    integer :: a, end, i, j, k, lo(3), hi(3), in(3), p

    ways = 0.0_wp
    do a = 1, 3
      do end = 1, 2
        if (.not. boundary%side(end, a)%mine) cycle
        lo = 1
        hi = boxes%n
        lo(a) = merge(0, hi(a), end == 1)
        hi(a) = lo(a)
        in = 0
        in(a) = merge(1, 0, end == 1)
        do k = lo(3), hi(3)
          do j = lo(2), hi(2)
            do i = lo(1), hi(1)
              p = parts%part(i + in(1), j + in(2), k + in(3))
              if (p == 0 .or. .not. space%area(i, j, k, a) > 0.0_wp) cycle
              if (boundary%side(end, a)%open(i, j, k)) ways(1, p) = 1.0_wp
              if (boundary%side(end, a)%flow(i, j, k) > 0.0_wp) ways(2, p) = 1.0_wp
            end do
          end do
        end do
      end do
    end do
    if (allocated(boundary%walls)) then
      do p = 1, parts%n
        associate (n => boxes%n)
          associate (inside => parts%part(1:n(1), 1:n(2), 1:n(3)) == p, walls => boundary%walls)
            if (any(inside .and. walls%nominal > 0.0_wp)) ways(2, p) = 1.0_wp
            if (.not. allocated(walls%vents)) cycle
            if (any(inside .and. walls%vents(1:n(1), 1:n(2), 1:n(3)))) ways(1, p) = 1.0_wp
          end associate
        end associate
      end do
    end if
    ways = reshape(boxes%comm%sum(reshape(ways, [size(ways)])), shape(ways))
    drained = ways(1, :) > 0.0_wp
    fed = ways(2, :) > 0.0_wp
  end subroutine find_ways

end module gas_parts
