!> The viscosity of eddies smaller than the cells (Smagorinsky, Mon. Weather Rev. 91 (1963) 99),
!>
!>   mu_t = rho (C_s Delta)^2 |S|,    |S|^2 = 2 S_ij S_ij,    S_ij = (d_j u_i + d_i u_j)/2 - delta_ij div u/3,
!>
!> Delta the cube root of a cell's volume, as if no wall cut it. C_s = (2/(3 K))^(3/4)/pi is 0.17 with Kolmogorov's constant
!> K = 1.5 (Lilly, Proc. IBM Sci. Comput. Symp. Environ. Sci. (1967) 195).
!>
!> The stress is eps mu_t 2 S. The part eps mu_t grad u is one with that of the gas: `eddies%eps` stands for eps in all viscous
!> terms, friction on walls included. What is left,
!>
!>   sum over b of d_b (eps mu_t (d_a u_b - delta_ab 2/3 div u)),
!>
!> vanishes where eps and mu_t are uniform, and is a force that does not change in the step. Both come from the
!> velocities at the start of the step: they are of first order in time as the steps are, and nothing has to be kept. With
!> them a step is stable whatever its length: |S|^2 >= 0 says that the part left is never larger than the other one.
!>
!> d_b u_a and d_a u_b, a /= b, live on the edges of cells, d_a u_a in their middles. |S|^2 of a cell has the mean of the squares
!> of its four edges: no velocity that swings from cell to cell escapes it. On a wall where the gas sticks d_b u_a is that of
!> the parabola of `bend`, on walls within the domain that of the straight line to them, on slip walls and outflows 0.
!> mu_t is not damped near walls.
module eddy_viscosity
  use gas_state, only: gas_state_t
  use kinds, only: wp
  use mesh, only: unit_step
  use momentum_cells, only: bend_at
  implicit none
  private
  public :: let_swirl, find_eddies, add_turned

contains

  !> Give the gas such eddies.
  subroutine let_swirl(state, constant)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(in) :: constant  !< C_s [-]

    allocate (state%eddies)
    state%eddies%constant = constant
    allocate (state%eddies%eps, source=state%eps)
    associate (n => state%boxes%n)
      allocate (state%eddies%viscosity(n(1), n(2), n(3)), source=0.0_wp)
    end associate
    if (.not. allocated(state%space)) return
    call state%halo%exchange_many(state%space%nearness)
    if (allocated(state%space%slide)) call state%halo%exchange_many(state%space%slide)
  end subroutine let_swirl

  !> Their viscosity in all cells, from void fractions, densities and velocities that are right in the halo, too.
  subroutine find_eddies(state)
    class(gas_state_t), intent(inout) :: state

    integer :: j, k

    associate (n => state%boxes%n, spacing => state%spacing, mu => state%eddies%viscosity)
      call find_rate(state, mu)
      do k = 1, n(3)
        do j = 1, n(2)
          mu(:, j, k) = state%eddies%constant**2*sqrt(mu(:, j, k)) &
            *(spacing(1)%width(1:n(1))*spacing(2)%width(j)*spacing(3)%width(k))**(2.0_wp/3.0_wp)
        end do
      end do
      if (allocated(state%ideal)) then
        mu = mu*state%ideal%density(1:n(1), 1:n(2), 1:n(3))
      else
        mu = mu*state%density
      end if
      state%eddies%eps(1:n(1), 1:n(2), 1:n(3)) = state%eps(1:n(1), 1:n(2), 1:n(3))*(1 + mu/state%viscosity)
    end associate
    call state%halo%exchange(state%eddies%eps)
  end subroutine find_eddies

  !> |S|^2 of my cells [1/s2]. With d_a for d_a u_a the middles have 2 sum d_a^2 - 2/3 (sum d_a)^2 = 2/3 sum of (d_a - d_b)^2.
  subroutine find_rate(state, rate)
    class(gas_state_t), intent(in) :: state
    real(wp), intent(out), contiguous :: rate(:,:,:)  !< (n1,n2,n3)

    real(wp), allocatable :: edge(:,:,:), other(:,:,:)
    real(wp) :: d(3)
    integer :: a, b, i, j, k, e(3), s(3), n(3)

    n = state%boxes%n
    do k = 1, n(3)
      do j = 1, n(2)
        do i = 1, n(1)
          d = stretching(state, [i, j, k])
          rate(i, j, k) = ((d(1) - d(2))**2 + (d(2) - d(3))**2 + (d(3) - d(1))**2)/1.5_wp
        end do
      end do
    end do
    allocate (edge(0:n(1), 0:n(2), 0:n(3)), other(0:n(1), 0:n(2), 0:n(3)))
    do a = 1, 2
      e = unit_step(a)
      do b = a + 1, 3
        s = unit_step(b)
        call find_slopes(state, a, b, edge)
        call find_slopes(state, b, a, other)
        edge = (edge + other)**2
        do k = 1, n(3)
          do j = 1, n(2)
            do i = 1, n(1)
              rate(i, j, k) = rate(i, j, k) + 0.25_wp*((edge(i, j, k) + edge(i - e(1), j - e(2), k - e(3))) &
                + (edge(i - s(1), j - s(2), k - s(3)) + edge(i - e(1) - s(1), j - e(2) - s(2), k - e(3) - s(3))))
            end do
          end do
        end do
      end do
    end do
    if (allocated(state%space)) call shear_at_walls(state, rate)
  end subroutine find_rate

  !> In cells with walls, and beside those that hold the gas, |S| is the shear u/y of the flows through their faces, y their
  !> distances from the wall; 0 where the gas slips.
  pure subroutine shear_at_walls(state, rate)
    class(gas_state_t), intent(in) :: state
    real(wp), intent(inout), contiguous :: rate(:,:,:)

    integer :: a, i, j, k, e(3)
    real(wp) :: shear(2)

    associate (n => state%boxes%n, space => state%space, u => state%velocity)
      where (space%beside) rate = 0.0_wp
      do a = 1, 3
        e = unit_step(a)
        do k = 1, n(3)
          do j = 1, n(2)
            do i = 1, n(1)
              if (.not. space%beside(i, j, k)) cycle
              shear = [u(i - e(1), j - e(2), k - e(3), a), u(i, j, k, a)]
              if (allocated(space%slide)) shear = shear - [space%slide(i - e(1), j - e(2), k - e(3), a), space%slide(i, j, k, a)]
              shear = shear*[space%nearness(i - e(1), j - e(2), k - e(3), a), space%nearness(i, j, k, a)]
              rate(i, j, k) = rate(i, j, k) + (1 - space%upper(i, j, k, a))*shear(1)**2 + space%upper(i, j, k, a)*shear(2)**2
            end do
          end do
        end do
      end do
    end associate
  end subroutine shear_at_walls

  !> d_a u_a of a cell, all three [1/s].
  pure function stretching(state, x) result(d)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: x(3)
    real(wp) :: d(3)

    associate (u => state%velocity, spacing => state%spacing)
      d(1) = (u(x(1), x(2), x(3), 1) - u(x(1) - 1, x(2), x(3), 1))/spacing(1)%width(x(1))
      d(2) = (u(x(1), x(2), x(3), 2) - u(x(1), x(2) - 1, x(3), 2))/spacing(2)%width(x(2))
      d(3) = (u(x(1), x(2), x(3), 3) - u(x(1), x(2), x(3) - 1, 3))/spacing(3)%width(x(3))
    end associate
  end function stretching

  !> d_b u_a on the edges of my cells along the third direction, of which that of index P is between the velocities a at P and
  !> P + e_b [1/s]. 0 where there is no such edge.
  subroutine find_slopes(state, a, b, slope)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, b
    real(wp), intent(out), contiguous :: slope(0:, 0:, 0:)  !< (0:n1,0:n2,0:n3)

    integer :: end, i, j, k, lo(3), s(3)
    real(wp) :: distance(0:state%boxes%n(1))

    slope = 0.0_wp
    if (.not. state%stencil(a)%active) return
    s = unit_step(b)
    lo = 1
    lo([a, b]) = 0
    associate (n => state%boxes%n, u => state%velocity, gap => state%spacing(b)%gap)
      if (b == 1) distance = gap(0:n(1))
      do k = lo(3), n(3)
        do j = lo(2), n(2)
          if (b > 1) distance = gap(merge(j, k, b == 2))
          do i = lo(1), n(1)
            slope(i, j, k) = (u(i + s(1), j + s(2), k + s(3), a) - u(i, j, k, a))/distance(i)
          end do
        end do
      end do
    end associate
    if (allocated(state%space)) call heed_walls(state, a, b, lo, slope)
    do end = 1, 2
      if (state%boundary%side(end, b)%mine) call bend_slopes(state, a, b, end, lo, slope)
    end do
  end subroutine find_slopes

  !> The slopes next to walls within the domain: over the distance of the middles of the two flows, or, where one of the faces is
  !> closed, from the wall to the other.
  pure subroutine heed_walls(state, a, b, lo, slope)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, b, lo(3)
    real(wp), intent(inout), contiguous :: slope(0:, 0:, 0:)

    integer :: i, j, k, e(3), s(3), x, y, z
    real(wp) :: part

    e = unit_step(a)
    s = unit_step(b)
    associate (n => state%boxes%n, space => state%space, u => state%velocity)
      do k = lo(3), n(3)
        z = k + s(3)
        do j = lo(2), n(2)
          y = j + s(2)
          do i = lo(1), n(1)
            x = i + s(1)
            if ((space%area(i, j, k, a) > 0.0_wp) .neqv. (space%area(x, y, z, a) > 0.0_wp)) then
              slope(i, j, k) = space%nearness(x, y, z, a)*u(x, y, z, a) - space%nearness(i, j, k, a)*u(i, j, k, a)
              if (allocated(space%slide)) slope(i, j, k) = slope(i, j, k) &
                - (space%nearness(x, y, z, a)*space%slide(x, y, z, a) - space%nearness(i, j, k, a)*space%slide(i, j, k, a))
            else
              part = 0.5_wp*(space%area(i, j, k, b) + space%area(i + e(1), j + e(2), k + e(3), b))
              if (part > 0.0_wp) slope(i, j, k) = slope(i, j, k)*space%bridge(i, j, k, b, a)/part
            end if
          end do
        end do
      end do
    end associate
  end subroutine heed_walls

  !> The slopes on the surface of the domain.
  pure subroutine bend_slopes(state, a, b, end, lo, slope)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, b, end, lo(3)
    real(wp), intent(inout), contiguous :: slope(0:, 0:, 0:)

    integer :: i, j, k, from(3), to(3), e(3), x(3), y(3), inward
    real(wp) :: own, next, grip(2), wall

    e = unit_step(a)
    from = lo
    to = state%boxes%n
    from(b) = merge(0, to(b), end == 1)
    to(b) = from(b)
    inward = 3 - 2*end
    call bend_at(state, b, end, own, next)
    associate (side => state%boundary%side(end, b), u => state%velocity, &
               width => state%spacing(b)%width(merge(1, state%boxes%n(b), end == 1)))
      do k = from(3), to(3)
        do j = from(2), to(2)
          do i = from(1), to(1)
            x = [i, j, k]
            if (end == 1) x(b) = x(b) + 1
            y = x + inward*unit_step(b)
            grip = min([side%grip(i, j, k), side%grip(i + e(1), j + e(2), k + e(3))], 1.0_wp)
            wall = 0.0_wp
            if (allocated(side%slide)) wall = 0.5_wp*(grip(1)*side%slide(i, j, k, a) &
                                                      + grip(2)*side%slide(i + e(1), j + e(2), k + e(3), a))
            associate (u_1 => u(x(1), x(2), x(3), a), u_2 => u(y(1), y(2), y(3), a), stick => 0.5_wp*sum(grip))
              slope(i, j, k) = inward*(own*(stick*u_1 - wall) - next*stick*(u_2 - u_1))/width
            end associate
          end do
        end do
      end do
    end associate
  end subroutine bend_slopes

  !> Add to the source of component a what the stress of the eddies has besides eps mu_t grad u.
  subroutine add_turned(state, a)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a

    real(wp), allocatable :: mu(:,:,:), flow(:,:,:)
    integer :: b

    associate (n => state%boxes%n)
      allocate (mu(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2), source=state%viscosity*(state%eddies%eps - state%eps))
      allocate (flow(-1:n(1), -1:n(2), -1:n(3)), source=0.0_wp)
    end associate
    call cross_middles(state, a, mu, flow)
    call gain(state, a, a, flow)
    do b = 1, 3
      if (b == a .or. .not. state%stencil(b)%active) cycle
      call cross_edges(state, a, b, mu, flow)
      call gain(state, a, b, flow)
    end do
  end subroutine add_turned

  !> Momentum a that comes down through the middles of cells [N], of the face below a cell.
  pure subroutine cross_middles(state, a, mu, flow)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a
    real(wp), intent(in), contiguous :: mu(-1:, -1:, -1:)  !< eps mu_t of cells [Pa s]
    real(wp), intent(inout), contiguous :: flow(-1:, -1:, -1:)

    integer :: i, j, k, e(3), hi(3), x, y, z
    real(wp) :: d(3)

    e = unit_step(a)
    hi = state%boxes%n
    do k = 1 - e(3), hi(3)
      z = k + e(3)
      do j = 1 - e(2), hi(2)
        y = j + e(2)
        do i = 1 - e(1), hi(1)
          x = i + e(1)
          d = stretching(state, [x, y, z])
          flow(i, j, k) = mu(x, y, z)*state%volume(x, y, z)/state%spacing(a)%width(dot_product(e, [x, y, z])) &
            *(d(a) - (d(1) + d(2) + d(3))/1.5_wp)
        end do
      end do
    end do
  end subroutine cross_middles

  !> Momentum a that comes down through the faces across b of the momentum cells [N]. On the surface of the domain two of
  !> the four cells that meet are there.
  subroutine cross_edges(state, a, b, mu, flow)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, b
    real(wp), intent(in), contiguous :: mu(-1:, -1:, -1:)  !< eps mu_t of cells [Pa s]
    real(wp), intent(inout), contiguous :: flow(-1:, -1:, -1:)

    real(wp), allocatable :: slope(:,:,:), along_x(:), along_y(:), along_z(:)
    integer :: i, j, k, e(3), s(3), lo(3)

    e = unit_step(a)
    s = unit_step(b)
    lo = 1
    lo([a, b]) = 0
    associate (n => state%boxes%n)
      allocate (slope(0:n(1), 0:n(2), 0:n(3)))
      allocate (along_x(0:n(1)), source=edge_shape(state, a, b, 1))
      allocate (along_y(0:n(2)), source=edge_shape(state, a, b, 2))
      allocate (along_z(0:n(3)), source=edge_shape(state, a, b, 3))
      call find_slopes(state, b, a, slope)
      if (allocated(state%space)) call narrow(state, a, b, lo, slope)
      do k = lo(3), n(3)
        do j = lo(2), n(2)
          do i = lo(1), n(1)
            flow(i, j, k) = along_x(i)*along_y(j)*along_z(k)*slope(i, j, k) &
              *(mu(i, j, k) + mu(i + e(1), j + e(2), k + e(3)) + mu(i + s(1), j + s(2), k + s(3)) &
                + mu(i + e(1) + s(1), j + e(2) + s(2), k + e(3) + s(3)))
          end do
        end do
      end do
    end associate
  end subroutine cross_edges

  !> What the grid along one direction contributes to the area of the faces across b of the momentum cells of component a, over
  !> the number of cells that meet there; the product of the three is A/4 or, on the surface, A/2.
  pure function edge_shape(state, a, b, direction) result(factor)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, b, direction
    real(wp) :: factor(0:state%boxes%n(direction))

    integer :: n

    n = state%boxes%n(direction)
    if (direction == a) then
      factor = state%spacing(a)%gap(0:n)
    else if (direction == b) then
      factor = 0.25_wp
      if (state%boundary%side(1, b)%mine) factor(0) = 0.5_wp
      if (state%boundary%side(2, b)%mine) factor(n) = 0.5_wp
    else
      factor = state%spacing(direction)%width(0:n)
    end if
  end function edge_shape

  !> Slopes times the open part of the faces that they act on.
  pure subroutine narrow(state, a, b, lo, slope)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: a, b, lo(3)
    real(wp), intent(inout), contiguous :: slope(0:, 0:, 0:)

    integer :: i, j, k, e(3)

    e = unit_step(a)
    associate (n => state%boxes%n, area => state%space%area)
      do k = lo(3), n(3)
        do j = lo(2), n(2)
          do i = lo(1), n(1)
            slope(i, j, k) = slope(i, j, k)*0.5_wp*(area(i, j, k, b) + area(i + e(1), j + e(2), k + e(3), b))
          end do
        end do
      end do
    end associate
  end subroutine narrow

  !> What comes down from above a face and leaves it below.
  pure subroutine gain(state, a, b, flow)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a, b
    real(wp), intent(in), contiguous :: flow(-1:, -1:, -1:)

    integer :: i, j, k, s(3)

    s = unit_step(b)
    associate (first => state%first(:, a), n => state%boxes%n)
      do k = first(3), n(3)
        do j = first(2), n(2)
          do i = first(1), n(1)
            state%source(i, j, k, a) = state%source(i, j, k, a) &
              + state%free(i, j, k, a)*(flow(i, j, k) - flow(i - s(1), j - s(2), k - s(3)))
          end do
        end do
      end do
    end associate
  end subroutine gain

end module eddy_viscosity
