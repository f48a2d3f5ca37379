!> Continuity of the gas and the pressure that enforces it.
!>
!>   rho V (eps - eps_old)/dt + sum of G_out = 0,    G = rho a u,    a = eps_f A
!>
!> or what comes in through the walls of a cell in the place of 0.
!>
!> A pressure correction p' changes the velocities by u' = -d (p'_above - p'_below); put into the continuity
!> equation it gives sum over faces of c (p' - p'_beyond) = -imbalance with c = rho a d. The density of an ideal gas grows
!> with p': see gas_density.
module pressure_correction
  use gas_state, only: gas_state_t, vents
  use kinds, only: wp
  use mesh, only: unit_step
  use momentum_cells, only: continue_across
  implicit none
  private
  public :: prepare_faces, prepare_pressure, update_flux, find_imbalance, correct

contains

  !> Passages of the faces, what cells store, and the given velocities: superficial velocity over void fraction.
  subroutine prepare_faces(state, dt)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(in) :: dt  !< [s]

    integer :: a

    do a = 1, 3
      call set_passages(state, a)
      call set_side(state, a, 1)
      call set_side(state, a, 2)
    end do
    associate (n => state%boxes%n)
      state%storage = state%density/dt*state%volume(1:n(1), 1:n(2), 1:n(3)) &
        *(state%eps(1:n(1), 1:n(2), 1:n(3)) - state%eps_old(1:n(1), 1:n(2), 1:n(3)))
      if (.not. allocated(state%seep)) return
      state%seep(1:n(1), 1:n(2), 1:n(3)) = state%density*state%boundary%walls%area*state%boundary%walls%flow
      if (allocated(state%ideal)) call heed_density(state)
      state%storage = state%storage - state%seep(1:n(1), 1:n(2), 1:n(3))
    end associate
    call state%halo%exchange(state%seep)
  end subroutine prepare_faces

  !> Where the velocity of what comes in through a wall is given, not its mass flow, its density is that of the cell when the step
  !> begins.
  pure subroutine heed_density(state)
    class(gas_state_t), intent(inout) :: state

    integer :: i, j, k

    associate (n => state%boxes%n, ideal => state%ideal, record => state%boundary%walls%record)
      do k = 1, n(3)
        do j = 1, n(2)
          do i = 1, n(1)
            if (ideal%by_mass(record(i, j, k))) cycle
            state%seep(i, j, k) = state%seep(i, j, k)*ideal%density(i, j, k)/state%density
          end do
        end do
      end do
    end associate
  end subroutine heed_density

  !> The void fraction of a face lies on the straight line between those of its two cells.
  subroutine set_passages(state, a)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a

    integer :: i, j, k, e(3)
    real(wp) :: nearer(-1:maxval(state%boxes%n) + 1)       ! (along a) share of the cell below a face
    real(wp), dimension(-1:state%boxes%n(1) + 1) :: area, share
    real(wp) :: edge

    e = unit_step(a)
    associate (n => state%boxes%n, eps => state%eps, width => state%spacing(a)%width, side => state%spacing)
      nearer(:n(a) + 1) = width(0:n(a) + 2)/(width(-1:n(a) + 1) + width(0:n(a) + 2))
      area = 1.0_wp
      if (a /= 1) area = side(1)%width(:n(1) + 1)
      if (a == 1) share = nearer(:n(1) + 1)
      do k = -1, n(3) + 1
        if (a == 3) share = nearer(k)
        do j = -1, n(2) + 1
          if (a == 2) share = nearer(j)
          edge = product(merge(1.0_wp, [side(2)%width(j), side(3)%width(k)], a == [2, 3]))
          do i = -1, n(1) + 1
            state%passage(i, j, k, a) = edge*area(i) &
              *(share(i)*eps(i, j, k) + (1 - share(i))*eps(i + e(1), j + e(2), k + e(3)))
          end do
        end do
      end do
    end associate
    if (allocated(state%space)) state%passage(:, :, :, a) = state%passage(:, :, :, a)*state%space%area(:, :, :, a)
  end subroutine set_passages

  !> The open area of a face across a [m2].
  pure function face_area(state, face, a) result(area)
    class(gas_state_t), intent(in) :: state
    integer, intent(in) :: face(3), a
    real(wp) :: area

    integer :: b

    area = 1.0_wp
    do b = 1, 3
      if (b /= a) area = area*state%spacing(b)%width(face(b))
    end do
    if (allocated(state%space)) area = area*state%space%area(face(1), face(2), face(3), a)
  end function face_area

  subroutine set_side(state, a, end)
    class(gas_state_t), intent(inout) :: state
    integer, intent(in) :: a, end

    integer :: i, j, k, lo(3), hi(3), inner(3)
    real(wp) :: inward, area

    if (.not. state%boundary%side(end, a)%mine) return
    lo = 0
    hi = state%boxes%n + 1
    lo(a) = merge(0, state%boxes%n(a), end == 1)
    hi(a) = lo(a)
    inner = merge(1, 0, end == 1)*unit_step(a)
    inward = merge(1.0_wp, -1.0_wp, end == 1)
    associate (side => state%boundary%side(end, a), eps => state%eps)
      do k = lo(3), hi(3)
        do j = lo(2), hi(2)
          do i = lo(1), hi(1)
            area = face_area(state, [i, j, k], a)
            state%passage(i, j, k, a) = area*eps(i + inner(1), j + inner(2), k + inner(3))
            if (side%open(i, j, k)) cycle
            if (state%passage(i, j, k, a) <= 0.0_wp) cycle  ! the rim beyond the domain
            state%velocity(i, j, k, a) = inward*side%flow(i, j, k)*area/state%passage(i, j, k, a)
          end do
        end do
      end do
    end associate
  end subroutine set_side

  !> The matrix of the pressure correction, the same for all iterations of a step.
  subroutine prepare_pressure(state)
    class(gas_state_t), intent(inout) :: state

    integer :: a

    ! the fluxes are made anew right after: their storage serves for the coefficients
    if (allocated(state%ideal)) then
      state%flux = state%passage*state%mobility
      call state%halo%exchange_many(state%flux)
      call state%solver%set_matrix(state%flux, state%ideal%capacity)
      return
    end if
    do a = 1, 3
      state%flux(:, :, :, a) = state%density*state%passage(:, :, :, a)*state%mobility(:, :, :, a)
    end do
    call state%halo%exchange_many(state%flux)
    call state%solver%set_matrix(state%flux)
  end subroutine prepare_pressure

  !> Mass flow through all faces of the box and one layer around it; across the surface of the domain it goes on.
  subroutine update_flux(state)
    class(gas_state_t), intent(inout) :: state

    integer :: a, i, j, k, end

    associate (n => state%boxes%n)
      do a = 1, 3
        if (allocated(state%ideal)) then
          state%flux(:, :, :, a) = state%ideal%face(:, :, :, a)*state%passage(:, :, :, a)*state%velocity(:, :, :, a)
        else
          do k = 0, n(3) + 1
            do j = 0, n(2) + 1
              do i = 0, n(1) + 1
                state%flux(i, j, k, a) = state%density*state%passage(i, j, k, a)*state%velocity(i, j, k, a)
              end do
            end do
          end do
        end if
        do end = 1, 2
          if (state%boundary%side(end, a)%mine) call continue_across(n, a, end, state%flux(:, :, :, a))
        end do
      end do
    end associate
  end subroutine update_flux

  !> What each cell loses and stores, which should be nothing, and the sum of its size over all ranks [kg/s].
  function find_imbalance(state) result(total)
    class(gas_state_t), intent(inout) :: state
    real(wp) :: total

    integer :: i, j, k

    total = 0.0_wp
    associate (n => state%boxes%n, g => state%flux)
      do k = 1, n(3)
        do j = 1, n(2)
          !$omp simd reduction(+:total)
          do i = 1, n(1)
            state%imbalance(i, j, k) = state%storage(i, j, k) &
              + (g(i, j, k, 1) - g(i - 1, j, k, 1)) + (g(i, j, k, 2) - g(i, j - 1, k, 2)) &
              + (g(i, j, k, 3) - g(i, j, k - 1, 3))
            total = total + abs(state%imbalance(i, j, k))
          end do
        end do
      end do
    end associate
    if (vents(state)) call let_out(state, total)
    total = state%boxes%comm%sum(total)
  end function find_imbalance

  !> What cells lose through walls that are outflows is no imbalance.
  subroutine let_out(state, total)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(out) :: total  !< what is left, see find_imbalance

    associate (n => state%boxes%n)
      associate (out => state%boundary%walls%vents(1:n(1), 1:n(2), 1:n(3)))
        state%vented = -sum(state%imbalance, out)
        where (out) state%imbalance = 0.0_wp
      end associate
    end associate
    total = sum(abs(state%imbalance))
  end subroutine let_out

  !> Solve for the pressure that takes the imbalance away, all but the part `reduction`, and apply it.
  subroutine correct(state, reduction)
    class(gas_state_t), intent(inout) :: state
    real(wp), intent(in) :: reduction

    integer :: a, i, j, k, e(3), iterations

    state%imbalance = -state%imbalance
    call state%solver%solve(state%imbalance, reduction, state%correction, iterations)
    state%report%pressure_iterations = state%report%pressure_iterations + iterations
    call state%halo%exchange(state%correction)
    if (allocated(state%ideal)) state%correction = state%correction/state%ideal%density
    do a = 1, 3
      if (.not. state%stencil(a)%active) cycle
      e = unit_step(a)
      associate (first => state%first(:, a), n => state%boxes%n, p => state%correction)
        do k = first(3), n(3)
          do j = first(2), n(2)
            do i = first(1), n(1)
              state%velocity(i, j, k, a) = state%velocity(i, j, k, a) &
                - state%mobility(i, j, k, a)*(p(i + e(1), j + e(2), k + e(3)) - p(i, j, k))
            end do
          end do
        end do
      end associate
    end do
    call add_correction(state)
    call state%halo%exchange(state%pressure)
    call state%halo%exchange_many(state%velocity)
  end subroutine correct

  !> p + p' - mu div(eps u)/eps with the divergence that the correction takes away: the viscous stress of the velocity
  !> change, which the mobilities leave out, is a pressure too. Without it a step much longer than the viscous time of
  !> a cell takes tens of iterations (Cahouet and Chabard, Int. J. Numer. Meth. Fluids 8 (1988) 869; Guermond and Shen,
  !> Math. Comput. 73 (2004) 1719, eq. 3.6). The imbalance of a cell that a wall cuts counts as if spread over the whole cell: over
  !> its open part it would be too much of a divergence, and the iterations may not end.
  subroutine add_correction(state)
    class(gas_state_t), intent(inout) :: state

    integer :: i, j, k
    real(wp) :: scale

    scale = state%viscosity/state%density
    associate (n => state%boxes%n, p => state%correction)
      if (allocated(state%space)) state%imbalance = state%space%volume(1:n(1), 1:n(2), 1:n(3))*state%imbalance
      do k = 1, n(3)
        do j = 1, n(2)
          do i = 1, n(1)
            p(i, j, k) = p(i, j, k) + scale/(state%volume(i, j, k)*state%eps(i, j, k))*state%imbalance(i, j, k)
          end do
        end do
      end do
      if (state%levels%n > 0) call state%levels%keep_levels(state%boxes%comm, p(1:n(1), 1:n(2), 1:n(3)))
      state%pressure(1:n(1), 1:n(2), 1:n(3)) = state%pressure(1:n(1), 1:n(2), 1:n(3)) + p(1:n(1), 1:n(2), 1:n(3))
    end associate
  end subroutine add_correction

end module pressure_correction
