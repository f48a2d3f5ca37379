!> What a case is and what that implies, in a few lines for --check and the start of a run.
module case_description
  use case, only: case_t
  use constants, only: is_set
  use contact_description, only: describe_contact
  use contact_settings, only: contact_settings_t
  use gas_settings, only: gas_settings_t, compressibility
  use kinds, only: wp
  use mapping, only: mapping_variance
  use outcome, only: outcome_t
  use parcel_plan, only: parcel_plan_t, new_parcel_plan, shortest_contact
  use described_line, only: line
  use surface, only: surface_t
  use step_control, only: step_limits_of
  use text, only: brief, shown
  implicit none
  private
  public :: describe_case

contains

  !> For a case without mistakes.
  subroutine describe_case(case, unit)
    type(case_t), intent(in) :: case
    integer, intent(in) :: unit

    call line(unit, 'case', trim(case%file//' '//trim(case%run%title)))
    call line(unit, 'run', 'to '//shown(case%run%end_time)//' s')
    if (is_set(case%run%wall_clock_limit)) call line(unit, '', 'stops with a restart file after ' &
                                                     //shown(case%run%wall_clock_limit)//' s of real time')
    call line(unit, 'domain', by(case%domain%upper - case%domain%lower)//' m, gravity '//shown(case%domain%gravity)//' m/s2')
    if (any(case%domain%periodic)) call line(unit, '', 'periodic in '//axes(case%domain%periodic))
    call describe_gas(case, unit)
    call describe_boundaries(case, unit)
    call describe_parcels(case, unit)
    call describe_output(case, unit)
  end subroutine describe_case

  subroutine describe_gas(case, unit)
    type(case_t), intent(in) :: case
    integer, intent(in) :: unit

    real(wp) :: steps

    if (.not. case%with_gas) then
      call line(unit, 'gas', 'none: no grid, no drag')
      return
    end if
    associate (domain => case%domain, step => case%gas_numerics%time_step)
      call line(unit, 'gas', density_words(case%gas)//', '//shown(case%gas%viscosity)//' Pa s')
      if (case%gas%turbulence_model == 'smagorinsky') call line(unit, '', "eddies smaller than a cell by Smagorinsky's "// &
                                                                'viscosity, C_s = '//shown(case%gas%smagorinsky_constant))
      call line(unit, 'grid', by(real(domain%cells, wp))//' = '//shown(product(domain%cells))//' cells of ' &
                //by(domain%axis%finest)//' m')
      if (.not. all(domain%axis%uniform)) call line(unit, '', 'up to '//by(domain%axis%coarsest)//' m')
      if (any(domain%cells == 1)) call line(unit, '', 'no flow in '//axes(domain%cells == 1)// &
                                            ', unless periodic: one cell across')
      if (any(abs(case%gas%pressure_drop) > 0)) call line(unit, '', 'driven by a pressure drop of ' &
                                                          //shown(case%gas%pressure_drop)//' Pa')
      if (case%gas%flow_given) call line(unit, '', 'driven by the pressure drop that keeps a mass flow of ' &
                                         //shown(case%gas%mass_flow)//' kg/s')
      steps = case%run%end_time/step
      associate (limits => step_limits_of(case%gas_numerics))
        call line(unit, 'gas steps', brief(steps)//' of '//shown(step)//' s, as given; halved up to ' &
                  //shown(limits%deepest)//' times where one does not converge')
        if (is_set(limits%maximum_courant)) call line(unit, '', 'or where the Courant number would be above ' &
                                                      //shown(limits%maximum_courant))
        if (limits%target_iterations > 0) call line(unit, '', 'or after one of more than ' &
                                                    //shown(limits%target_iterations)//' iterations')
      end associate
    end associate
  end subroutine describe_gas

  pure function density_words(gas) result(words)
    type(gas_settings_t), intent(in) :: gas
    character(len=:), allocatable :: words

    words = shown(gas%density)//' kg/m3'
    if (gas%density_law /= 'ideal') return
    words = 'ideal, '//brief(gas%density)//' kg/m3 at '//shown(gas%reference_pressure + gas%pressure)//' Pa and ' &
      //shown(gas%temperature)//' K, sound at '//brief(1/sqrt(compressibility(gas)))//' m/s'
  end function density_words

  subroutine describe_boundaries(case, unit)
    type(case_t), intent(in) :: case
    integer, intent(in) :: unit

    character(len=:), allocatable :: text
    integer :: i

    do i = 1, size(case%boundaries)
      associate (region => case%boundaries(i))
        text = trim(region%id)//':'
        if (case%with_gas) text = text//' '//trim(region%kind)
        if (region%surface == 'walls') text = text//trim(merge(' along  ', ' through', index(region%kind, 'slip') > 0)) &
                                              //' walls within the domain'
        if (is_set(region%velocity)) text = text//' at '//shown(region%velocity)//' m/s'
        if (is_set(region%mass_flow)) text = text//' of '//shown(region%mass_flow)//' kg/s'
        if (is_set(region%volume_flow)) text = text//' of '//shown(region%volume_flow)//' m3/s'
        if (region%profile == 'parabola') text = text//' as a parabola'
        if (region%profile == 'table') text = text//' as in '//trim(region%file)
        if (allocated(region%times)) text = text//', times factors from '//shown(region%times(1))//' to ' &
                                            //shown(region%times(size(region%times)))//' s'
        if (any(abs(region%wall_velocity) > 0)) text = text//' moving at '//shown(region%wall_velocity)//' m/s'
        if (region%kind == 'outflow') text = text//' at '//shown(merge(region%pressure, case%gas%pressure, &
                                                                       is_set(region%pressure)))//' Pa'
        if (region%parcels == 'open') text = text//' open to parcels'
        text = text//made_of(case, region%material)
        call line(unit, 'boundary', text)
      end associate
    end do
    if (.not. all(case%domain%periodic)) call line(unit, '', 'the rest of the surface: wall' &
                                                //made_of(case, case%contact%wall_material))
  end subroutine describe_boundaries

  !> ' of steel', nothing where no material is named.
  pure function made_of(case, material) result(words)
    type(case_t), intent(in) :: case
    integer, intent(in) :: material
    character(len=:), allocatable :: words

    words = ''
    if (material > 0) words = ' of '//trim(case%contact%materials(material)%id)
  end function made_of

  subroutine describe_parcels(case, unit)
    type(case_t), intent(in) :: case
    integer, intent(in) :: unit

    type(parcel_plan_t) :: plans(size(case%fills))
    type(outcome_t) :: outcome
    integer :: i

    if (.not. case%with_parcels) then
      call line(unit, 'parcels', 'none: gas alone')
      call describe_walls(case, unit)
      return
    end if
    call line(unit, 'parcels', weighting_words(case)//'; seed '//shown(case%parcels%seed))
    do i = 1, size(case%fills)
      call new_parcel_plan(case, i, plans(i), outcome)
      call describe_fill(case, i, plans(i), unit)
    end do
    call describe_walls(case, unit)
    call describe_contact(case, unit)
    call describe_steps(case, shortest_contact(case, plans), unit)
    if (case%with_gas) call describe_coupling(case, unit)
  end subroutine describe_parcels

  subroutine describe_coupling(case, unit)
    type(case_t), intent(in) :: case
    integer, intent(in) :: unit

    character(len=:), allocatable :: text

    associate (coupling => case%coupling)
      text = 'drag of '//trim(coupling%drag)
      if (coupling%drag == 'syamlal_obrien') text = text//' with c1 '//shown(coupling%syamlal_c1)//' and d1 ' &
                                                    //shown(coupling%syamlal_d1)
      if (coupling%polydispersity /= 'none') text = text//', by size over the mean around ('//trim(coupling%polydispersity)//')'
      call line(unit, 'coupling', text//'; the gas sees a void fraction of '//shown(coupling%minimum_void_fraction)//' or more')
      call describe_mapping(case, unit)
      if (coupling%polydispersity == 'beetstra') call line(unit, '', 'particles of one size only would feel 1.064 times the drag')
    end associate
  end subroutine describe_coupling

  !> Where it is not the usual one.
  subroutine describe_mapping(case, unit)
    type(case_t), intent(in) :: case
    integer, intent(in) :: unit

    character(len=:), allocatable :: text
    logical :: coarse(3)

    associate (coupling => case%coupling, domain => case%domain)
      if (coupling%mapping == 'linear' .and. .not. is_set(coupling%width)) return
      text = 'the eight cells around it'
      if (coupling%mapping == 'cell') text = 'the cell it is in'
      if (is_set(coupling%width)) then
        text = text//', spread by '//shown(coupling%width)//' m (standard deviation)'
        coarse = mapping_variance(coupling%mapping)*domain%axis%finest**2 >= coupling%width**2
        coarse = coarse .and. domain%cells > 1
        if (any(coarse)) text = text//', in '//axes(coarse)//' the cells alone do that or more'
      end if
    end associate
    call line(unit, '', 'a parcel meets '//text)
  end subroutine describe_mapping

  subroutine describe_walls(case, unit)
    type(case_t), intent(in) :: case
    integer, intent(in) :: unit

    character(len=:), allocatable :: text
    integer :: i

    do i = 1, size(case%walls)
      associate (wall => case%walls(i))
        text = trim(wall%id)//': '//trim(wall%kind)
        if (wall%kind == 'cylinder' .and. wall%has_length()) text = text//' '//shown(wall%length)//' m long'
        if (wall%kind == 'cylinder' .and. .not. wall%has_length()) text = text//', parcels '//trim(wall%side)
        if (wall%kind == 'mesh') text = text//mesh_words(case%surfaces(i))//' from '//trim(wall%file)
        if (wall%blocks_gas() .and. wall%kind == 'plane') text = text//', gas where the normal points'
        if (wall%blocks_gas() .and. wall%kind /= 'plane') text = text//', gas '//trim(wall%gas_side)
        text = text//made_of(case, wall%material)
        if (wall%stays) text = text//', at rest, its surface'
        if (norm2(wall%velocity) > 0) text = text//', running at '//brief(norm2(wall%velocity))//' m/s'
        if (norm2(wall%angular_velocity) > 0) text = text//', turning at '//brief(norm2(wall%angular_velocity))//' rad/s'
        call line(unit, 'wall', text)
      end associate
    end do
    if (.not. case%with_gas) return
    if (all([(case%walls(i)%blocks_gas(), i=1, size(case%walls))])) return
    text = 'walls'
    if (any([(case%walls(i)%blocks_gas(), i=1, size(case%walls))])) text = 'the other walls'
    call line(unit, '', 'the gas passes through '//text)
  end subroutine describe_walls

  pure function mesh_words(surface) result(words)
    type(surface_t), intent(in) :: surface
    character(len=:), allocatable :: words

    real(wp) :: extent(3)

    extent = maxval(surface%vertex, dim=2) - minval(surface%vertex, dim=2)
    words = ' of '//shown(surface%n)//' triangles'
    if (surface%degenerate > 0) words = words//' ('//shown(surface%degenerate)//' without an area left out)'
    words = words//', '//trim(merge('closed', 'open  ', size(surface%open_edge, 2) == 0))//', '//brief(extent(1))//' by ' &
            //brief(extent(2))//' by '//brief(extent(3))//' m,'
  end function mesh_words

  pure function weighting_words(case) result(words)
    type(case_t), intent(in) :: case
    character(len=:), allocatable :: words

    associate (settings => case%parcels)
      select case (settings%weighting)
      case ('ssw')
        words = 'ssw: each stands for '//shown(settings%weight)//' particles'
      case ('ssp')
        words = 'ssp: each is '//shown(settings%diameter)//' m wide'
      case ('blend')
        words = 'blend: each stands for '//shown(settings%weight)//' ('//shown(settings%reference_diameter)//'/d)**' &
                //shown(3*settings%blend_exponent)//' particles'
      case default
        words = 'dem: each is one particle'
      end select
    end associate
  end function weighting_words

  subroutine describe_fill(case, i, plan, unit)
    type(case_t), intent(in) :: case
    integer, intent(in) :: i
    type(parcel_plan_t), intent(in) :: plan
    integer, intent(in) :: unit

    associate (fill => case%fills(i), powder => case%powders(case%fills(i)%powder))
      if (.not. plan%known) then
        call line(unit, 'fill', trim(fill%id)//': parcels of '//trim(powder%id)//' from '//trim(fill%file))
        return
      end if
      call line(unit, 'fill', trim(fill%id)//': about '//brief(plan%parcels)//' parcels, '// &
                brief(plan%volume*powder%density)//' kg of '//trim(powder%id)//', solids ' &
                //brief(plan%volume/product(fill%upper - fill%lower))//' of the box')
      call line(unit, '', trim(powder%id)//': '//trim(powder%distribution)//', mean diameter by number ' &
                //brief(plan%means(1))//', by mass '//brief(plan%means(2))//', Sauter '//brief(plan%means(3))//' m')
      call line(unit, '', 'particles '//range_of(plan%particle)//' m, parcels '//range_of(plan%diameter) &
                //' m wide, of '//range_of(plan%weight)//' particles')
    end associate
  end subroutine describe_fill

  !> How many steps the parcels take.
  subroutine describe_steps(case, shortest, unit)
    type(case_t), intent(in) :: case
    real(wp), intent(in) :: shortest  !< collision [s]; huge if not known
    integer, intent(in) :: unit

    real(wp) :: step

    if (.not. shortest < huge(shortest)) return
    step = shortest/case%des%steps_per_collision
    step = case%gas_numerics%time_step/ceiling(case%gas_numerics%time_step/step)
    call line(unit, 'solids steps', brief(case%run%end_time/step)//' of '//brief(step)//' s, '// &
              shown(case%des%steps_per_collision)//' or more in the shortest collision, '//brief(shortest) &
              //' s'//impact_words(case%contact)//',')
    call line(unit, '', 'more where a parcel would move by over a tenth of the smallest radius in one')
  end subroutine describe_steps

  pure function impact_words(contact) result(words)
    type(contact_settings_t), intent(in) :: contact
    character(len=:), allocatable :: words

    words = ''
    if (contact%law == 'hertz') words = ' at '//shown(contact%impact_velocity)//' m/s'
  end function impact_words

  subroutine describe_output(case, unit)
    type(case_t), intent(in) :: case
    integer, intent(in) :: unit

    integer :: i

    associate (output => case%output)
      call line(unit, 'output', trim(output%folder)//every(', parcels', output%parcels_interval)// &
                every(', gas', output%gas_interval)//every(', restart', output%restart_interval)// &
                every(', monitors', output%monitor_interval))
    end associate
    do i = 1, size(case%monitors)
      associate (monitor => case%monitors(i))
        call line(unit, 'monitor', trim(monitor%id)//': '//trim(monitor%quantity)//' in a '//trim(monitor%kind) &
                  //every('', monitor%interval))
      end associate
    end do
  end subroutine describe_output

  pure function every(what, interval) result(words)
    character(len=*), intent(in) :: what
    real(wp), intent(in) :: interval  !< [s]
    character(len=:), allocatable :: words

    words = ''
    if (is_set(interval)) words = what//' every '//shown(interval)//' s'
  end function every

  !> 'x x y x z'
  pure function by(x) result(words)
    real(wp), intent(in) :: x(3)
    character(len=:), allocatable :: words

    words = brief(x(1))//' x '//brief(x(2))//' x '//brief(x(3))
  end function by

  pure function axes(flag) result(words)
    logical, intent(in) :: flag(3)
    character(len=:), allocatable :: words

    integer :: a

    words = ''
    do a = 1, 3
      if (flag(a)) words = words//' '//'xyz' (a:a)
    end do
    words = trim(adjustl(words))
  end function axes

  pure function range_of(x) result(words)
    real(wp), intent(in) :: x(2)
    character(len=:), allocatable :: words

    words = brief(x(1))
    if (brief(x(2)) /= words) words = words//' to '//brief(x(2))
  end function range_of

end module case_description
